# SPDX-License-Identifier: Apache-2.0
"""Recordings, estimates and forces as arrays, against the text of their files."""

import csv
import os
import subprocess

import numpy as np
import pytest
from conftest import shared

import palpate

CSV = """time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm
0.0,7,tip,OK,1,0,0,0,1,2,3,0.1
0.0,7,shaft,MISSING,,,,,,,,
0.1,8,tip,OK,0,1,0,0,nan,2,3,
0.2,9,tip,OK,,,,,4,5,6,
0.2,9,shaft,OK,1,0,0,0,7,8,9,
"""


@pytest.fixture
def small(tmp_path):
    path = tmp_path / "small.csv"
    path.write_text(CSV)
    return path


def test_small_file(small):
    recording = palpate.read_recording(small)
    assert len(recording) == 3 and recording.sensor_names == ["tip", "shaft"] and recording.source == str(small)
    np.testing.assert_array_equal(recording.frames["time_s"], [0.0, 0.1, 0.2])
    np.testing.assert_array_equal(recording.frames["frame"], [7, 8, 9])
    assert list(recording["tip"]["status"]) == ["OK", "OK", "OK"]
    assert list(recording["shaft"]["status"]) == ["MISSING", "ABSENT", "OK"]
    nan = np.nan
    np.testing.assert_allclose(recording["tip"]["position_m"], [[1e-3, 2e-3, 3e-3], [nan, 2e-3, 3e-3], [4e-3, 5e-3, 6e-3]])
    np.testing.assert_array_equal(recording["tip"]["quaternion_wxyz"], [[1, 0, 0, 0], [0, 1, 0, 0], [nan] * 4])
    np.testing.assert_allclose(recording["shaft"]["position_m"], [[nan] * 3, [nan] * 3, [7e-3, 8e-3, 9e-3]])
    np.testing.assert_allclose(recording["tip"]["error_m"], [1e-4, nan, nan])
    assert [frame.number for frame in recording] == [7, 8, 9]
    assert recording[-1].status == ["OK", "OK"] and recording[1].tendon_moment_Nm is None
    np.testing.assert_allclose(recording[-1].position_m, [[4e-3, 5e-3, 6e-3], [7e-3, 8e-3, 9e-3]])


def test_a_pipe(small, tmp_path):
    """Nothing of it is read before its turn."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with subprocess.Popen(["cp", small, pipe]) as process:
        assert len(palpate.read_recording(pipe)) == 3
    assert process.returncode == 0


def test_shared_file_row_by_row():
    path = shared("recordings/faults.tracker.csv")
    recording = palpate.read_recording(path)
    with open(path, newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["sensor"] == "tip"]
    assert list(recording["tip"]["status"]) == [row["status"] for row in rows]
    expected = np.array([[float(row[key] or "nan") for key in ("tx_mm", "ty_mm", "tz_mm")] for row in rows])
    np.testing.assert_allclose(recording["tip"]["position_m"], 1e-3 * expected, rtol=1e-15)


def test_from_arrays_and_back(small, tmp_path):
    position = np.array([[1.0, 2.0, 3.0], [np.nan] * 3, [4.0, 5.0, 6.0]]) * 1e-3
    quaternion = np.array([[1.0, 0.0, 0.0, 0.0], [np.nan] * 4, [0.0, 0.0, 0.0, 1.0]])
    recording = palpate.Recording([0.0, 0.1, 0.2], {"tip": (position, quaternion), "point": (position, None)})
    assert list(recording["tip"]["status"]) == ["OK", "MISSING", "OK"]
    recording.write_csv(tmp_path / "out.csv")
    back = palpate.read_recording(tmp_path / "out.csv")
    for name in ("tip", "point"):
        np.testing.assert_array_equal(back[name]["status"], recording[name]["status"])
        np.testing.assert_allclose(back[name]["position_m"], recording[name]["position_m"], atol=1e-9)
        np.testing.assert_allclose(back[name]["quaternion_wxyz"], recording[name]["quaternion_wxyz"], atol=1e-6)


def test_arrays_are_estimated_as_their_file(heartbeat):
    """A user's own arrays, cut out of structured ones (strided), give what the file gives."""
    read = palpate.read_recording(heartbeat.recording)
    own = palpate.Recording(read.frames["time_s"], {
        name: (read[name]["position_m"], read[name]["quaternion_wxyz"]) for name in read.sensor_names})
    from_file = palpate.estimate(heartbeat.recording, heartbeat.catheter)
    np.testing.assert_array_equal(palpate.estimate(own, heartbeat.catheter).force_tip_N, from_file.force_tip_N)
    np.testing.assert_array_equal(palpate.estimate(read, heartbeat.catheter).force_tip_N, from_file.force_tip_N)
    bound = palpate.read_recording(heartbeat.recording, heartbeat.catheter)
    np.testing.assert_array_equal(palpate.estimate(bound, heartbeat.catheter).force_tip_N, from_file.force_tip_N)


def test_order_of_the_catheter(heartbeat, tmp_path):
    text = heartbeat.toml.read_text()
    swapped = text.replace('"tip"', '"?"').replace('"shaft"', '"tip"').replace('"?"', '"shaft"')
    catheter = palpate.Catheter.from_text(swapped)
    bound = palpate.read_recording(heartbeat.recording, catheter)
    assert bound.sensor_names == ["shaft", "tip"]
    with pytest.raises(palpate.InputError, match="expected \"tip\""):
        palpate.estimate(bound, heartbeat.catheter)


def test_forces(heartbeat):
    forces = palpate.read_forces(heartbeat.truth)
    table = np.genfromtxt(heartbeat.truth, delimiter=",", names=True)
    np.testing.assert_array_equal(forces["time_s"], table["time_s"])
    np.testing.assert_array_equal(forces["force_tip_N"][:, 1], table["fy_tip_N"])


def test_estimate_csv(tmp_path):
    header = ("time_s,fx_tip_N,fy_tip_N,fz_tip_N,sigma_x_N,sigma_y_N,sigma_z_N,cov_xy_N2,cov_xz_N2,cov_yz_N2,fx_base_N,"
              "fy_base_N,fz_base_N,status,sensors_used,nis,dof,evaluations\n")
    path = tmp_path / "e.csv"
    path.write_text(header + "0.5,1,2,3,0.1,0.2,0.3,0.001,0.002,0.003,4,5,6,UPDATED,2,11.5,12,3\n"
                             "0.6,1,2,3,0.1,0.2,0.3,0,0,0,4,5,6,HELD,0,0,0,0\n")
    e = palpate.read_estimate(path)
    np.testing.assert_allclose(e.sigma_tip_N[0], [0.1, 0.2, 0.3])
    np.testing.assert_allclose(e.covariance_tip_N2[0], [[0.01, 0.001, 0.002], [0.001, 0.04, 0.003], [0.002, 0.003, 0.09]])
    assert not {"stiffness_Nm2", "precurvature_per_m"} & set(e.rows.dtype.names)  # no word of them in the file
    assert list(e.status) == ["UPDATED", "HELD"] and list(e.measured) == [True, False] and list(e["dof"]) == [12, 0]


def test_catheter_file(heartbeat):
    catheter = heartbeat.catheter
    np.testing.assert_allclose(catheter.bending_stiffness_Nm2, [0.2612e-3, 0.16664e-3], rtol=1e-12)
    assert catheter.length_m == pytest.approx(0.07) and [s.name for s in catheter.sensors] == ["tip", "shaft"]
    assert catheter.stiffness_sigma_fraction == pytest.approx(0.05) and catheter.tendon is None
    assert catheter.sensors[0].noise_rad == pytest.approx(np.deg2rad(0.17)) and catheter.sensors[0].kind == "pose"
    R = catheter.T_tracker_base.R
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
    there = catheter.T_tracker_base @ catheter.T_tracker_base.inverse()
    np.testing.assert_allclose(there.R, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(catheter.T_tracker_base.apply([0.0, 0.0, 0.0]), catheter.T_tracker_base.p)
    assert palpate.ForceObserver(catheter).options == catheter.observer_options
    assert palpate.ForceObserver(catheter, method="ukf").options["method"] == "ukf"


def test_keywords_and_file_are_one_catheter(heartbeat):
    told = heartbeat.catheter
    own = palpate.Catheter(
        length_m=told.length_m, bending_stiffness_Nm2=told.bending_stiffness_Nm2,
        torsional_stiffness_Nm2=told.torsional_stiffness_Nm2, precurvature_per_m=told.precurvature_per_m,
        sensors=told.sensors, base=told.T_tracker_base, stiffness_sigma_fraction=0.05,
        precurvature_sigma_per_m=(0.5, 0.5, 0.2), base_position_sigma_m=0.3e-3, base_rotation_sigma_rad=np.deg2rad(0.3))
    theirs, ours = (palpate.estimate(heartbeat.recording, one).force_tip_N for one in (told, own))
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12)


def test_what_is_shown_is_what_is_used(heartbeat):
    """An array that could be edited would be seen to change, and the estimate would not."""
    recording, catheter = palpate.read_recording(heartbeat.recording), heartbeat.catheter
    for rows in (recording.frames, *(recording[name] for name in recording.sensor_names)):
        for column in rows.dtype.names:
            with pytest.raises(ValueError, match="read-only"):
                rows[column][0] = rows[column][1]
    with pytest.raises(ValueError, match="read-only"):
        recording["tip"]["position_m"][:] += 0.01
    moved = palpate.Recording(recording.frames["time_s"], {
        name: (recording[name]["position_m"] + 0.001, recording[name]["quaternion_wxyz"]) for name in recording.sensor_names})
    before, after = palpate.estimate(recording, catheter), palpate.estimate(moved, catheter)
    assert np.abs(after.force_tip_N - before.force_tip_N).max() > 1e-3


def test_edits_that_are_used(heartbeat):
    """Estimates and a truth are rows and nothing else: whoever asks, asks them."""
    estimates = palpate.estimate(heartbeat.recording, heartbeat.catheter)
    before = palpate.evaluate(estimates, heartbeat.truth).mean_N
    estimates["force_tip_N"][:] += [0.5, 0.0, 0.0]
    np.testing.assert_allclose(palpate.evaluate(estimates, heartbeat.truth).mean_N, before + [0.5, 0.0, 0.0])
    truth = palpate.read_forces(heartbeat.truth)
    truth["force_tip_N"][:] += [0.5, 0.0, 0.0]
    np.testing.assert_allclose(palpate.evaluate(estimates, truth).mean_N, before, atol=1e-12)


@pytest.mark.parametrize("name", ["a,b", "a\nb", 'a"b', " a", "a ", "\ta", "", "a\rb"])
def test_names_that_a_csv_cannot_say(tmp_path, name):
    recording = palpate.Recording([0.0], {"tip": (np.zeros((1, 3)), None), name: (np.zeros((1, 3)), None)})
    with pytest.raises(palpate.InputError) as caught:
        recording.write_csv(tmp_path / "out.csv")
    shown = "".join(c if c >= " " else "?" for c in name)
    assert str(caught.value).startswith(f"sensor '{shown}': expected a name") and not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["a b", "Prüfling", "#1", "'", ";", "nan"])
def test_names_that_it_can(tmp_path, name):
    recording = palpate.Recording([0.0], {name: (np.zeros((1, 3)), None)})
    recording.write_csv(tmp_path / "out.csv")
    assert palpate.read_recording(tmp_path / "out.csv").sensor_names == [name]


def test_frames_by_number(small):
    recording = palpate.read_recording(small)
    for index in (3, -4, 10**30, -10**30):
        with pytest.raises(IndexError, match=f"frame {index} of 3"):
            recording[index]
