#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The claims as ratios, from the JSON that tools/benchmark.sh leaves. Usage: benchmark_ratios.py FOLDER

A time is the least of the row's repetitions (CPU time): what other programs do can only add to it. In brackets the
ratio of the medians. Exit code 0 whether or not a target is met: a benchmark reports.
"""
import json
import os
import statistics
import sys

# name, numerator, denominator, factor on the denominator, "<=" or ">=", target
TEXTBOOK = [
    ("textbook: update / 70 of its rods, poses", "textbook/update/poses", "textbook/rod", 70, "<=", 1.2),
    ("textbook: update / 70 of its rods, Eq. (11)", "textbook/update/tip_and_curvature", "textbook/rod", 70, "<=", 1.2),
    ("textbook, x86-64-v3: update / 70 of its rods", "textbook/update/poses/v3", "textbook/rod/v3", 70, "<=", 1.2),
]
UPDATE = [
    ("rod with 3 sensitivities / rod", "rod/value+3_sensitivities", "rod/value", 1, "<=", 2.0),
    ("textbook / bare update, poses", "textbook/update/poses", "bare_update/iekf/poses", 1, ">=", 20.0),
    ("textbook / bare update, Eq. (11)", "textbook/update/tip_and_curvature", "bare_update/iekf/tip_and_curvature", 1,
     ">=", 20.0),
    ("textbook, x86-64-v3 / bare update, poses", "textbook/update/poses/v3", "bare_update/iekf/poses", 1, ">=", 20.0),
]
OBSERVER = [
    ("textbook / ForceObserver, poses, random walk", "textbook/update/poses", "update/iekf/poses/random_walk", 1, ">=",
     20.0),
    ("textbook / ForceObserver, poses, default", "textbook/update/poses", "update/iekf/poses/constant_velocity", 1,
     ">=", 20.0),
]
INSTRUCTION_SETS = ("baseline", "avx2", "avx512")
US = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}


def read(folder, name):
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        return None
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def read_rows(report):
    """name -> ([CPU time in us of every repetition], counter of evaluations or None)"""
    rows = {}
    for row in report["benchmarks"]:
        if row["run_type"] == "iteration" and not row.get("error_occurred"):
            times, _ = rows.setdefault(row["name"], ([], row.get("evals")))
            times.append(row["cpu_time"] * US[row["time_unit"]])
    return rows


def claim(name, value, sense, target, note=""):
    met = value <= target if sense == "<=" else value >= target
    print(f"{name:60}{value:10.3g} {note:12} target {sense} {target:<5g} {'met' if met else 'MISSED'}")


def claim_ratios(rows, claims):
    for name, top, bottom, factor, sense, target in claims:
        if top not in rows or bottom not in rows:
            print(f"{name:60}{'no row':>10}")
            continue
        a, b = rows[top][0], rows[bottom][0]
        middle = statistics.median(a) / (factor * statistics.median(b))
        claim(name, min(a) / (factor * min(b)), sense, target, f"({middle:.3g})")


def print_rows(rows):
    print(f"{'row (CPU time)':56}{'least us':>10}{'median us':>11}{'rods':>7}")
    for name, (times, evaluations) in sorted(rows.items()):
        rods = f"{evaluations:7.2f}" if evaluations is not None else ""
        print(f"{name:56}{min(times):10.2f}{statistics.median(times):11.2f}{rods}")


def print_sets(folder):
    """A file that does not say it used its set was run by a library without a choice."""
    for wanted in INSTRUCTION_SETS:
        report = read(folder, f"rows.{wanted}.json")
        if report is None or report["context"].get("instruction_set") != wanted:
            print(f"\ninstruction set {wanted}: no such choice")
            continue
        print(f"\ninstruction set {wanted}")
        claim_ratios(read_rows(report), UPDATE)


def print_batch(report):
    print(f"\n{'batch, one core':60}{'ns a rod':>10}{'scalar':>10}{'times':>8}")
    rows = [row for row in report["benchmarks"] if "times_scalar" in row]
    for row in rows:
        print(f"{row['name'].split('/min_time')[0]:60}{row['ns_a_rod']:10.0f}{row['scalar_ns_a_rod']:10.0f}"
              f"{row['times_scalar']:8.2f}")
    for row in rows[-4:]:  # the widest set
        claim(f"scalar / {row['name'].split('/min_time')[0]}", row["times_scalar"], ">=", 5.0)
    for row in report["benchmarks"]:
        if "speed_up" in row:
            print(f"batch, two workers: {row['ns_a_rod']:.0f} ns a rod by the wall clock, {row['speed_up']:.2f} x one "
                  f"worker (best against best: {row['best_speed_up']:.2f})")


def print_accuracy(rows):
    print(f"\n{'RMSE [mN]':76}{'Fx':>7}{'Fy':>7}{'Fz':>7}{'all':>7}")
    size = {}
    for row in rows:
        x, y, z = row["rmse_mN"]
        size[row["recording"], row["filter"]] = total = (x * x + y * y + z * z) ** 0.5
        print(f"{row['recording'] + ': ' + row['filter']:76}{x:7.2f}{y:7.2f}{z:7.2f}{total:7.2f}")
    for recording in sorted({row["recording"] for row in rows}):
        best = {layout: value for (name, text), value in size.items() if name == recording
                for layout in ("poses", "Eq. (11)") if text.startswith(f"textbook, {layout}, exact R")}
        for layout, yardstick in best.items():
            same = size[recording, f"iterated update, {layout}, the same R and Q"]
            claim(f"{recording}: error, iterated update / textbook, {layout}", same / yardstick, "<=", 1.001)
        ours = size[recording, "ForceObserver, default"]
        claim(f"{recording}: error, ForceObserver / textbook at its best", ours / min(best.values()), "<=", 1.0)


def print_latency(report):
    where = f"core {report['core']}" if report["core"] >= 0 else "any core"
    locked = "locked" if report["memory_locked"] else "not locked"
    print(f"\nlatency: {report['updates']} updates of the default observer on {report['scenario']}, {where}, "
          f"memory {locked}")
    columns = ("p50", "p99", "p99_9", "max", "p99_9_over_p50")
    print(f"{'':40}" + "".join(f"{c:>16}" for c in columns))
    for key in ("wall_us", "cpu_us", "least_cpu_us", "evaluations"):
        print(f"{key:40}" + "".join(f"{report[key][c]:16.1f}" for c in columns))
    for key in ("wall_us", "cpu_us", "least_cpu_us"):
        claim(f"p99.9 / p50, {key}", report[key]["p99_9_over_p50"], "<=", 3.0)
    for key in ("allocations", "minor_page_faults", "major_page_faults"):
        claim(key, report[key], "<=", 0)
    print(f"preempted {report['preemptions']} times")


def main(folder):
    report = read(folder, "rows.json")
    rows = read_rows(report)
    print_rows(rows)
    print(f"\nthe library's own choice: {report['context'].get('instruction_set', 'one kernel')}")
    claim_ratios(rows, TEXTBOOK + UPDATE + OBSERVER)
    print_sets(folder)
    for name, show in (("batch", print_batch), ("accuracy", print_accuracy), ("latency", print_latency)):
        part = read(folder, name + ".json")
        if part is not None:
            show(part)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
