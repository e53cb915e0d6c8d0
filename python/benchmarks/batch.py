# SPDX-License-Identifier: Apache-2.0
"""Batch of rods from Python against the same batch in C++, in turn in one run, compared by their medians.

    PYTHONPATH=build/release/python python3 python/benchmarks/batch.py build/release/bin/benchmark_python_batch

The C++ side is another process; each waits while the other works. Exit code 1 where Python takes more than --most times
as long.
"""

import argparse
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

import palpate


def catheter() -> palpate.Catheter:
    return palpate.Catheter(
        length_m=0.07,
        bending_stiffness_Nm2=(0.2612e-3, 0.16664e-3),
        torsional_stiffness_Nm2=0.1645e-3,
        precurvature_per_m=(24.57, 0.0, 0.0),
        sensors=[palpate.Sensor("tip", arc_length_m=0.07)],
    )


def forces(rods: int) -> np.ndarray:
    """Uniform in a ball of 0.4 N."""
    random = np.random.default_rng(20260101)
    direction = random.normal(size=(rods, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return 0.4 * np.cbrt(random.random((rods, 1))) * direction


def compare(program: str, rods: int, rounds: int, sensitivities: bool, reuse: bool) -> float:
    force_N, shaft = forces(rods), catheter()
    with tempfile.NamedTemporaryFile() as file:
        force_N.tofile(file.name)
        command = [program, file.name, str(int(sensitivities)), str(int(reuse))]
        peer = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        cpp_s, python_s = [], []
        for round_ in range(rounds + 3):
            peer.stdin.write("\n")
            peer.stdin.flush()
            spent, total = map(float, peer.stdout.readline().split())
            start = time.perf_counter()
            shapes = palpate.solve_batch(shaft, force_N, sensitivities=sensitivities)
            took = time.perf_counter() - start
            assert abs(shapes.tip.position_base_m.sum() - total) < 1e-9 * rods, "not the same rods"
            if round_ >= 3:  # the first ones fill caches
                cpp_s.append(spent)
                python_s.append(took)
        peer.stdin.close()
        peer.wait()
    ratio = statistics.median(python_s) / statistics.median(cpp_s)
    what = ("3 sensitivities" if sensitivities else "values") + (", C++ into the same memory" if reuse else ", C++ into new memory")
    print(f"{rods} rods, {what}: C++ {1e3 * statistics.median(cpp_s):.2f} ms, Python "
          f"{1e3 * statistics.median(python_s):.2f} ms, ratio {ratio:.3f} (of the best {min(python_s) / min(cpp_s):.3f})")
    return ratio


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", help="benchmark_python_batch")
    parser.add_argument("--rods", type=int, default=100_000)
    parser.add_argument("--rounds", type=int, default=31)
    parser.add_argument("--most", type=float, default=1.2)
    options = parser.parse_args()
    ratios = [compare(options.program, options.rods, options.rounds, sensitivities, reuse)
              for sensitivities in (False, True) for reuse in (True, False)]
    return int(max(ratios) > options.most)


if __name__ == "__main__":
    sys.exit(main())
