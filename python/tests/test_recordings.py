# SPDX-License-Identifier: Apache-2.0
"""The recordings that another program made: Python gives the numbers of C++ (all digits) and of the command line."""

import csv
import json
import subprocess
import warnings

import numpy as np
import pytest
from conftest import RECORDINGS, Case, palpate_program, program, shared

import palpate


def dumped(case, *flags):
    command = [program("PALPATE_DUMP"), str(case.toml), str(case.recording), *flags]
    if case.tendon:
        command += ["--tendon", str(case.tendon)]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return np.array([[float(field) for field in line.split(",")] for line in text.splitlines()])


def side_by_side(e):
    """The columns of the dump."""
    n = len(e)
    status = np.array([palpate._palpate.STATUSES.index(word) for word in e.status])
    parts = [e.time_s, status, e["sensors_used"], e["dof"], e["evaluations"], e["nis"], e.force_tip_N, e.covariance_tip_N2,
             e["force_base_N"], e["R_base_tip"], e["stiffness_Nm2"], e["stiffness_sigma_Nm2"], e["precurvature_per_m"],
             e["precurvature_sigma_per_m"], e["sigma_by_source_N"]]
    return np.hstack([np.asarray(part, float).reshape(n, -1) for part in parts])


def estimated(case, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", palpate.PalpateWarning)
        return palpate.estimate(case.recording, case.catheter, tendon=case.tendon, **options)


def largest_difference(ours, theirs):
    """In units of 1, or of the number where that is larger."""
    assert ours.shape == theirs.shape
    same = (ours == theirs) | (np.isnan(ours) & np.isnan(theirs))
    return np.where(same, 0.0, np.abs(ours - theirs) / np.maximum(np.abs(theirs), 1.0)).max()


@pytest.mark.parametrize("smooth", [False, True], ids=["online", "smoothed"])
@pytest.mark.parametrize("name", RECORDINGS)
def test_same_numbers_as_cpp(name, smooth, tmp_path):
    case = Case(name, tmp_path)
    difference = largest_difference(side_by_side(estimated(case, smooth=smooth)), dumped(case, *["--smooth"] * smooth))
    print(f"{name} {'smoothed' if smooth else 'online'}: largest difference {difference:.1e}")
    assert difference <= 1e-12


def test_same_numbers_with_stiffness(tmp_path):
    case = Case("stiffness_drift", tmp_path)
    ours = side_by_side(estimated(case, state=["force", "stiffness"]))
    assert largest_difference(ours, dumped(case, "--stiffness")) <= 1e-12


@pytest.mark.parametrize("name", RECORDINGS)
def test_same_numbers_as_the_command_line(name, tmp_path):
    case, out = Case(name, tmp_path), tmp_path / "estimate.csv"
    tendon = ["--tendon", case.tendon] if case.tendon else []
    ran = palpate_program("estimate", "--catheter", case.toml, case.recording, "--out", out, *tendon)
    assert ran.returncode == 0, ran.stderr
    ours = estimated(case)
    with open(out, newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == list(ours.status)
    for i, axis in enumerate("xyz"):  # the file has nine digits
        for column, numbers in (("f{}_tip_N", ours.force_tip_N), ("sigma_{}_N", ours.sigma_tip_N),
                                ("f{}_base_N", ours["force_base_N"])):
            assert [row[column.format(axis)] for row in rows] == [f"{number:.9g}" for number in numbers[:, i]]


@pytest.mark.parametrize("name", ["faults", "jumps", "stiffness_drift"])
def test_frame_by_frame_is_the_same(name, tmp_path):
    case = Case(name, tmp_path)
    offline = estimated(case)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", palpate.PalpateWarning)
        recording = palpate.read_recording(case.recording, case.catheter, tendon=case.tendon)
    by_frame, by_arrays = palpate.ForceObserver(case.catheter), palpate.ForceObserver(case.catheter)
    tendon = recording.frames["tendon_moment_Nm"]
    sigma_Nm = 1.0448e-4  # of stiffness_drift.tendon.csv, in every row
    for i, frame in enumerate(recording):
        one = by_frame.update_frame(frame)
        assert one.status == offline.status[i]
        np.testing.assert_array_equal(one.force_tip_N, offline.force_tip_N[i])
        np.testing.assert_array_equal(one.covariance_tip_N2, offline.covariance_tip_N2[i])
        pull = {} if np.isnan(tendon[i, 0]) else {"tendon_moment_Nm": tendon[i], "tendon_sigma_Nm": sigma_Nm}
        other = by_arrays.update(frame.time_s, frame.position_m, frame.quaternion_wxyz, **pull)
        assert other.status == one.status
        np.testing.assert_allclose(other.force_tip_N, one.force_tip_N, rtol=0, atol=1e-12)


def test_force_is_right(heartbeat):
    """Against the truth, with the bound that the recordings' maker computed for one frame and exact parameters."""
    bound_N = json.loads(shared("recordings/bounds.json").read_text())["heartbeat"]["rms_bound_tip_frame_N"]
    found = palpate.evaluate(estimated(heartbeat, consider_uncertainty=False), heartbeat.truth)
    assert np.all(found.rmse_N < bound_N)
    assert 2.5 < found.mean_nees < 3.5
