# SPDX-License-Identifier: Apache-2.0
"""What was recorded live, against what `palpate export` writes of the same file."""

import csv
import json
import math
import sqlite3
import subprocess
import time

import numpy as np
import pytest
from conftest import ROOT, palpate_program, program

import palpate

SCENARIO = ROOT / "examples/scenarios/beating_heart.toml"
DURATION_S = 2.0


def run(*arguments):
    ran = palpate_program(*arguments)
    assert ran.returncode == 0, ran.stderr
    return ran


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A tracker's recording and its catheter file, run.*; the session of it run.palpate, as it was felt live; and what
    the command line exports of that, exported.*."""
    folder = tmp_path_factory.mktemp("session")
    run("simulate", SCENARIO, "--duration", DURATION_S, "--out", folder / "run")
    run("record", folder / "run.tracker.csv", "--catheter", folder / "run.catheter.toml", "--fast", "--out",
        folder / "run.palpate")
    run("export", folder / "run.palpate", "--out", folder / "exported")
    return folder


def nearly(ours, theirs, err_msg):
    np.testing.assert_allclose(ours, theirs, rtol=4e-16, atol=0, err_msg=err_msg)


def same_recording(ours, theirs):
    """Of a few lengths no number of millimetres reads back to the last bit, and the export says so: the nearest does."""
    assert ours.sensor_names == theirs.sensor_names and len(ours) == len(theirs) > 0
    for column in ("time_s", "frame", "tendon_moment_Nm"):
        np.testing.assert_array_equal(ours.frames[column], theirs.frames[column])
    for name in ours.sensor_names:
        for column in theirs[name].dtype.names:
            same = np.testing.assert_array_equal if column in ("status", "quaternion_wxyz") else nearly
            same(ours[name][column], theirs[name][column], err_msg=f"{name} {column}")


def same_estimates(ours, theirs):
    """A CSV keeps some nine digits."""
    assert len(ours) == len(theirs) > 0
    for column in theirs.rows.dtype.names:
        if theirs[column].dtype.kind in "iU":
            np.testing.assert_array_equal(ours[column], theirs[column], err_msg=column)
        else:
            np.testing.assert_allclose(ours[column], theirs[column], rtol=1e-5, atol=1e-8, err_msg=column)


def events_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [(float(row["device_time_s"] or "nan"), row["name"], json.loads(row["data"] or "{}"))
                for row in csv.DictReader(file)]


def same_events(ours, path):
    theirs = events_of(path)
    assert [(event, data) for _, _, event, data in ours] == [(name, data) for _, name, data in theirs]
    np.testing.assert_array_equal([event.time_s for event in ours], [time_s for time_s, _, _ in theirs])


def test_recording(folder):
    session = palpate.read_recording(folder / "run.palpate")
    same_recording(session, palpate.read_recording(folder / "exported.tracker.csv"))
    assert session.source == str(folder / "run.palpate") and session.notes == []
    assert session.catheter.to_toml() == palpate.Catheter.from_toml(folder / "exported.catheter.toml").to_toml()
    assert len(session.frames["output_time_s"]) == len(session) and np.all(np.diff(session.frames["received_ns"]) >= 0)
    same_events(session.events, folder / "exported.events.csv")


def test_estimate(folder):
    live = palpate.read_estimate(folder / "run.palpate")
    same_estimates(live, palpate.read_estimate(folder / "exported.estimate.csv"))
    np.testing.assert_array_equal(live.time_s, palpate.read_recording(folder / "run.palpate").frames["time_s"])
    assert live.catheter.to_toml() == palpate.Catheter.from_toml(folder / "run.catheter.toml").to_toml()
    same_events(live.events, folder / "exported.events.csv")


def test_estimated_anew(folder):
    """To the last bit, as `palpate replay` finds; from the file, from what was read of it, for its catheter or not."""
    live = palpate.read_estimate(folder / "run.palpate")
    session = palpate.read_recording(folder / "run.palpate")
    for again in (palpate.estimate(folder / "run.palpate", live.catheter), palpate.estimate(session, session.catheter),
                  palpate.estimate(palpate.read_recording(folder / "run.palpate", live.catheter), live.catheter)):
        for column in ("time_s", "force_tip_N", "covariance_tip_N2", "status", "nis", "sigma_by_source_N", "R_base_tip",
                       "evaluations", "stiffness_sigma_Nm2"):
            np.testing.assert_array_equal(again[column], live[column], err_msg=column)
    other = palpate.estimate(session, session.catheter, method="ekf")
    assert not np.array_equal(other.force_tip_N, live.force_tip_N)


def test_two_lines(folder):
    live = palpate.read_estimate(folder / "run.palpate")
    axes = palpate.plot.plot_force(live)
    assert axes is not None
    found = palpate.evaluate(folder / "run.palpate", folder / "run.force.csv")
    assert found.frames > 0 and max(found.rmse_N) < 0.2


def test_frame_by_frame(folder):
    session = palpate.read_recording(folder / "run.palpate")
    observer = palpate.ForceObserver(session.catheter)
    forces = [observer.update_frame(frame).force_tip_N for frame in session]
    np.testing.assert_array_equal(forces, palpate.read_estimate(folder / "run.palpate").force_tip_N)


def test_demo(tmp_path):
    """As it stands in the tutorial."""
    run("serve", "--demo", "--for", "1.5", "--record", tmp_path / "demo.palpate", "--openigtlink-port", "0",
        "--dashboard-port", "0")
    run("export", tmp_path / "demo.palpate", "--out", tmp_path / "demo")
    same_recording(palpate.read_recording(tmp_path / "demo.palpate"), palpate.read_recording(tmp_path / "demo.tracker.csv"))
    live = palpate.read_estimate(tmp_path / "demo.palpate")
    same_estimates(live, palpate.read_estimate(tmp_path / "demo.estimate.csv"))
    same_events(live.events, tmp_path / "demo.events.csv")


def test_events(folder, tmp_path):
    """A tracker that falls silent, and comes back."""
    lines = (folder / "run.tracker.csv").read_text().splitlines()
    half = len(lines) // 2
    command = [program("PALPATE_BINARY"), "record", "-", "--catheter", folder / "run.catheter.toml", "--out",
               tmp_path / "gap.palpate"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as process:
        process.stdin.write("\n".join(lines[:half]) + "\n")
        process.stdin.flush()
        time.sleep(1.5)
        process.stdin.write("\n".join(lines[half:]) + "\n")
        process.stdin.close()
        assert process.wait(30) == 0
    run("export", tmp_path / "gap.palpate", "--out", tmp_path / "gap")
    session = palpate.read_recording(tmp_path / "gap.palpate")
    same_recording(session, palpate.read_recording(tmp_path / "gap.tracker.csv"))
    same_events(session.events, tmp_path / "gap.events.csv")
    stale = [event for event in session.events if event.event == "stale"]
    assert stale and len(stale[0].data["forecast_force_tip_N"]) == 3
    assert all(event.catheter == session.events[0].catheter for event in stale)
    assert any(event.event == "live" and event.time_s > stale[0].time_s for event in session.events)


@pytest.fixture(scope="module")
def pair(folder):
    """Two catheters in one session: the second has other frames."""
    run("simulate", SCENARIO, "--duration", DURATION_S / 2, "--seed", 7, "--out", folder / "other")
    settings = folder / "two.toml"
    settings.write_text("schema = 1\n[openigtlink]\non = false\n[dashboard]\non = false\n[recording]\n"
                        f"path = \"two.palpate\"\n" + "".join(
                            f"[[catheter]]\nname = \"{name}\"\nfile = \"{file}.catheter.toml\"\n[catheter.source]\n"
                            f"kind = \"file\"\npath = \"{file}.tracker.csv\"\n" for name, file in
                            (("left", "run"), ("right", "other"))))
    run("serve", settings, "--for", 3)
    run("export", folder / "two.palpate", "--out", folder / "both")
    return folder / "two.palpate"


@pytest.mark.parametrize("name", ["left", "right"])
def test_one_of_several(folder, pair, name):
    session = palpate.read_recording(pair, catheter_name=name)
    same_recording(session, palpate.read_recording(folder / f"both.{name}.tracker.csv"))
    live = palpate.read_estimate(pair, catheter_name=name)
    same_estimates(live, palpate.read_estimate(folder / f"both.{name}.estimate.csv"))
    same_events(live.events, folder / f"both.{name}.events.csv")
    assert {event.catheter for event in live.events} <= {name, None}
    first = {"left": "run", "right": "other"}[name]
    assert live.catheter.to_toml() == palpate.Catheter.from_toml(folder / f"{first}.catheter.toml").to_toml()


def message(call, *arguments, **keywords):
    with pytest.raises(palpate.InputError) as caught:
        call(*arguments, **keywords)
    return str(caught.value)


@pytest.mark.parametrize("read", [palpate.read_recording, palpate.read_estimate])
def test_which_one(pair, tmp_path, read):
    ran = palpate_program("export", pair, "--catheter", "middle", "--out", tmp_path / "x")
    assert ran.returncode == 2 and ran.stderr.strip() == f"palpate: {message(read, pair, catheter_name='middle')}"
    assert message(read, pair) == f"{pair}: has 2 catheters: expected catheter_name=, one of left, right"


def test_one_of_several_estimated_anew(folder, pair):
    for name in ("left", "right"):
        live = palpate.read_estimate(pair, catheter_name=name)
        again = palpate.estimate(pair, live.catheter, catheter_name=name)
        np.testing.assert_array_equal(again.force_tip_N, live.force_tip_N)
    assert message(palpate.estimate, pair, live.catheter) == \
        f"{pair}: has 2 catheters: expected catheter_name=, one of left, right"
    assert "expected one of its 2: left, right" in message(palpate.estimate, pair, live.catheter, catheter_name="middle")
    assert message(palpate.estimate, pair, live.catheter, catheter_nam="left").startswith("option 'catheter_nam': expected")
    assert message(palpate.estimate, pair, live.catheter, catheter_name="left", metod="ekf").startswith("option 'metod'")
    for bad in ("a\ud800", "a\0b"):
        assert message(palpate.estimate, pair, live.catheter, catheter_name=bad).startswith("catheter_name = ")
    for other in (palpate.read_recording(pair, catheter_name="left"), folder / "run.tracker.csv"):
        told = message(palpate.estimate, other, live.catheter, catheter_name="left")
        assert told.startswith("catheter_name: expected a session")


@pytest.mark.parametrize("read", [palpate.read_recording, palpate.read_estimate])
def test_foreign_files(folder, tmp_path, read):
    """Another program's database, a later version's, one that is cut in its first page: as the command line says it."""
    other = tmp_path / "other.palpate"
    with sqlite3.connect(other) as database:
        database.execute("CREATE TABLE session (key, value)")
    later = tmp_path / "later.palpate"
    later.write_bytes((folder / "run.palpate").read_bytes())
    with sqlite3.connect(later) as database:
        database.execute("PRAGMA user_version = 99")
    cut = tmp_path / "cut.palpate"
    cut.write_bytes((folder / "run.palpate").read_bytes()[:1000])
    for file in (other, later, cut):
        ran = palpate_program("export", file, "--out", tmp_path / "x")
        assert ran.returncode == 2 and ran.stderr.strip() == f"palpate: {message(read, file)}"


def test_only_sessions_have_names(folder, pair):
    for read in (palpate.read_recording, palpate.read_estimate):
        assert "expected a session" in message(read, folder / "exported.estimate.csv", catheter_name="left")
        for bad in ("", 5, b"left"):
            with pytest.raises(TypeError, match="catheter_name"):
                read(pair, catheter_name=bad)
    catheter = palpate.Catheter.from_toml(folder / "run.catheter.toml")
    assert "expected alone" in message(palpate.read_recording, [pair, folder / "run.tracker.csv"], catheter)
    assert "has its own" in message(palpate.read_recording, folder / "run.palpate", catheter, tendon="tendon.csv")
    assert "has its own" in message(palpate.estimate, folder / "run.palpate", catheter, tendon="tendon.csv")


def test_damage(folder, tmp_path):
    """A page in the middle that a disk has lost: its rows are told and left out, as `palpate export` does."""
    file = tmp_path / "damaged.palpate"
    data = bytearray((folder / "run.palpate").read_bytes())
    page = int.from_bytes(data[16:18], "big") or 65536
    middle = len(data) // page // 2 * page
    data[middle:middle + page] = bytes([0xA5]) * page
    file.write_bytes(data)
    told = [line.removeprefix("palpate: warning: ") for line in
            run("export", file, "--out", tmp_path / "left").stderr.strip().splitlines()]
    assert told
    with pytest.warns(palpate.PalpateWarning) as caught:
        session = palpate.read_recording(file)
    assert [str(one.message) for one in caught] == told and caught[0].filename == __file__
    with pytest.warns(palpate.PalpateWarning) as caught:
        live = palpate.read_estimate(file)
    assert list(live.warnings) == told and caught[0].filename == __file__
    assert 0 < len(live) < len(palpate.read_estimate(folder / "run.palpate"))
    same_recording(session, palpate.read_recording(tmp_path / "left.tracker.csv"))
    same_estimates(live, palpate.read_estimate(tmp_path / "left.estimate.csv"))
    np.testing.assert_array_equal(session.frames["time_s"], live.time_s)


@pytest.mark.parametrize("change", ["UPDATE sensor SET name = CAST(X'fffe' AS TEXT)", "DELETE FROM sensor",
                                    "DELETE FROM sensor WHERE position = 0", "INSERT INTO sensor VALUES (0, 7, 'x')"])
def test_names_of_sensors_that_are_lost(folder, tmp_path, change):
    """They stand in the catheter file as well."""
    file = tmp_path / "names.palpate"
    file.write_bytes((folder / "run.palpate").read_bytes())
    with sqlite3.connect(file) as database:
        database.execute(change)
    with pytest.warns(palpate.PalpateWarning, match="the names of its sensors are not what was written"):
        recording = palpate.read_recording(file)
    whole = palpate.read_recording(folder / "exported.tracker.csv")
    assert recording.sensor_names == whole.sensor_names
    for name in whole.sensor_names:
        np.testing.assert_array_equal(recording[name]["status"], whole[name]["status"])
        np.testing.assert_array_equal(recording[name]["quaternion_wxyz"], whole[name]["quaternion_wxyz"])


def test_nothing_is_kept_of_the_file(folder):
    """Arrays own their data: what was read outlives the reader, and may be written to."""
    live = palpate.read_estimate(folder / "run.palpate")
    event_times = [event.time_s for event in live.events]
    rows = live.rows
    del live
    rows["force_tip_N"][0] = 1.0
    assert rows.flags.owndata and rows.flags.writeable and all(isinstance(t, float) for t in event_times)
    assert math.isfinite(rows["time_s"].sum())
