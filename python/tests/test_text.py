# SPDX-License-Identifier: Apache-2.0
"""Text and paths that are not UTF-8, or hold what no file can have."""

import os

import numpy as np
import pytest
from conftest import ROOT

import palpate

SURROGATE, NUL = "a\ud800b", "a\0b"
GOOD = {"length_m": 0.07, "bending_stiffness_Nm2": (2e-4, 2e-4), "torsional_stiffness_Nm2": 1e-4}


def test_paths_of_any_bytes(heartbeat, tmp_path):
    """As the file system has them: a folder that another encoding named."""
    folder = os.fsdecode(os.fsencode(tmp_path) + b"/M\xfcll")
    os.mkdir(folder)
    toml, csv, out = (os.path.join(folder, name) for name in ("c.toml", "r.csv", "out.csv"))
    for file, source in ((toml, heartbeat.toml), (csv, heartbeat.recording)):
        with open(file, "wb") as copy:
            copy.write(source.read_bytes())
    catheter = palpate.Catheter.from_toml(toml)
    recording = palpate.read_recording(csv)
    assert recording.source.endswith("M\\xfcll/r.csv")
    recording.write_csv(out)
    assert len(palpate.read_recording([out], catheter)) == len(recording)
    np.testing.assert_array_equal(palpate.estimate(csv, catheter).force_tip_N,
                                  palpate.estimate(recording, catheter).force_tip_N)
    with pytest.raises(palpate.InputError, match=r"M\\xfcll/none.csv"):
        palpate.read_recording(os.path.join(folder, "none.csv"))
    fit = palpate.identify_stiffness(palpate.Catheter.from_toml(ROOT / "examples/stiffness/catheter.toml"),
                                     ROOT / "examples/stiffness/cases.toml")
    written = os.path.join(folder, "new.toml")
    fit.write(ROOT / "examples/stiffness/catheter.toml", written)
    assert os.path.isfile(written)


def refused(name, call, /, *arguments, **keywords):
    with pytest.raises(palpate.InputError) as caught:
        call(*arguments, **keywords)
    assert str(caught.value).startswith(name) and "expected" in str(caught.value)
    str(caught.value).encode("utf-8")


@pytest.mark.parametrize("bad", [SURROGATE, NUL], ids=["surrogate", "NUL"])
def test_paths(paper, heartbeat, bad):
    recording = palpate.Recording([0.0], {"tip": (np.zeros((1, 3)), None)})
    refused("path", palpate.Catheter.from_toml, bad)
    refused("recording", palpate.read_recording, bad)
    refused("recording", palpate.read_recording, [bad], paper)
    refused("tendon", palpate.read_recording, "r.csv", paper, tendon=bad)
    refused("recording", palpate.estimate, bad, paper)
    refused("tendon", palpate.estimate, "r.csv", paper, tendon=bad)
    refused("path", palpate.read_estimate, bad)
    refused("path", palpate.read_forces, bad)
    refused("scenario", palpate.simulate, bad)
    refused("file", recording.write_csv, bad)
    refused("cases", palpate.identify_stiffness, paper, bad)
    refused("estimate", palpate.evaluate, bad, heartbeat.truth)
    refused("truth", palpate.evaluate, palpate.Estimates(np.zeros(0, [
        ("time_s", "f8"), ("force_tip_N", "f8", 3), ("covariance_tip_N2", "f8", (3, 3)), ("status", "U9")])), bad)


@pytest.mark.parametrize("bad", [SURROGATE, NUL], ids=["surrogate", "NUL"])
def test_words(paper, bad):
    sensors, rows = [palpate.Sensor("tip", arc_length_m=0.07)], np.zeros((2, 3))
    refused("text", palpate.Catheter.from_text, bad)
    refused("name", palpate.Catheter.from_text, "schema = 1", bad)
    refused("name", palpate.Catheter, **GOOD, sensors=sensors, name=bad)
    refused("tendon", palpate.Catheter, **GOOD, sensors=sensors, tendon=bad)
    refused("ignore_sensors[0]", palpate.Catheter, **GOOD, sensors=sensors, ignore_sensors=[bad])
    refused("Catheter: keyword", palpate.Catheter, **GOOD, sensors=sensors, **{bad: 1})
    refused("name", palpate.Sensor, bad)
    refused("kind", palpate.Sensor, "tip", bad)
    refused("markers[1]", palpate.Sensor, "tip", markers=["a", bad])
    refused("accuracy", palpate.solve, paper, accuracy=bad)
    refused("method", palpate.ForceObserver, paper, method=bad)
    refused("option", palpate.ForceObserver, paper, **{bad: 1})
    refused("state", palpate.ForceObserver, paper, state=[bad])
    refused("source", palpate.Recording, [0.0], {}, source=bad)
    refused("sensors", palpate.Recording, [0.0, 1.0], {bad: (rows, None)})
    refused("unknowns", palpate.identify_stiffness, paper, [], unknowns=bad)
    refused("method", palpate.identify_stiffness, paper, [], method=bad)
    refused("case.name", palpate.identify_stiffness, paper, [palpate.LoadCase(bad, np.zeros(3), [0.0], rows[:1])])
    refused("clamp", palpate.fit_arc, paper, ([0.01, 0.02], rows), clamp=bad)
