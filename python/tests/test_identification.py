# SPDX-License-Identifier: Apache-2.0
"""What is put into made-up measurements is found again; and the command line finds the same."""

import json
import warnings

import numpy as np
import pytest
from conftest import ROOT, palpate_program

import palpate

TRUE_EI, GUESS_EI, GJ, LENGTH = (0.30e-3, 0.20e-3), (0.25e-3, 0.25e-3), 0.18e-3, 0.07
PLACES = np.array([0.02, 0.04, 0.06, 0.07])


def shaft(bending, precurvature=(20.0, 0.0, 0.0), **more):
    return palpate.Catheter(length_m=LENGTH, bending_stiffness_Nm2=bending, torsional_stiffness_Nm2=GJ,
                            precurvature_per_m=precurvature, **{"sensors": [palpate.Sensor("tip", arc_length_m=LENGTH)], **more})


def test_stiffness_from_points():
    """Shapes under tip forces; the load is what those forces are in the base frame."""
    cases = []
    for name, force in {"x": (0.02, 0.0, 0.0), "y": (0.0, 0.02, 0.0), "xy": (-0.015, 0.02, -0.01)}.items():
        shape = palpate.solve(shaft(TRUE_EI), force, arc_lengths_m=PLACES)
        cases.append(palpate.LoadCase(name, shape.T_base_tip.R @ force, PLACES, shape.position_base_m, sigma_m=1e-5))
    fit = palpate.identify_stiffness(shaft(GUESS_EI), cases, unknowns="bending,torsion")
    assert fit.converged and [name for name, _, _ in fit.unknowns] == ["EI1", "EI2", "GJ"]
    np.testing.assert_allclose(fit.stiffness_Nm2, [*TRUE_EI, GJ], rtol=1e-3)
    np.testing.assert_allclose(fit.catheter.bending_stiffness_Nm2, fit.stiffness_Nm2[:2])
    other = palpate.identify_stiffness(shaft(GUESS_EI), cases, unknowns="bending,torsion", method="nelder-mead")
    np.testing.assert_allclose(other.stiffness_Nm2, fit.stiffness_Nm2, rtol=1e-3)


def test_stiffness_from_a_file(tmp_path):
    folder = ROOT / "examples/stiffness"
    ran = palpate_program("identify", "stiffness", "--catheter", folder / "catheter.toml", "--cases", folder / "cases.toml",
                          "--out", tmp_path / "identified.toml")
    assert ran.returncode == 0, ran.stderr
    fit = palpate.identify_stiffness(palpate.Catheter.from_toml(folder / "catheter.toml"), folder / "cases.toml")
    theirs = palpate.Catheter.from_toml(tmp_path / "identified.toml")
    np.testing.assert_allclose(fit.stiffness_Nm2[:2], theirs.bending_stiffness_Nm2, rtol=1e-4)


def written(path):
    return path.read_text(encoding="utf-8")


def test_stiffness_is_written_as_the_command_line_writes_it(tmp_path):
    folder = ROOT / "examples/stiffness"
    for unknowns in ("bending", "scale", "bending,torsion"):
        ran = palpate_program("identify", "stiffness", "--catheter", folder / "catheter.toml", "--cases",
                              folder / "cases.toml", "--unknowns", unknowns, "--out", tmp_path / "theirs.toml")
        assert ran.returncode == 0, ran.stderr
        fit = palpate.identify_stiffness(palpate.Catheter.from_toml(folder / "catheter.toml"), folder / "cases.toml",
                                         unknowns=unknowns)
        fit.write(folder / "catheter.toml", tmp_path / "ours.toml")
        assert written(tmp_path / "ours.toml") == written(tmp_path / "theirs.toml")
        assert written(tmp_path / "ours.toml") != written(folder / "catheter.toml")


def test_registration_is_written_as_the_command_line_writes_it(tmp_path):
    """Rounded to the digits of a tracker CSV, from which both read. A base sensor has its mounting written."""
    base = palpate.Pose(TURN, [0.1, -0.05, 0.2])
    stated = tmp_path / "stated.toml"
    stated.write_text("# kept\n" + shaft(TRUE_EI, sensors=SENSORS, name="c").to_toml(), encoding="utf-8")
    files = []
    for k in (5.0, 20.0, 40.0):
        files.append(tmp_path / f"{k:.0f}.tracker.csv")
        at_rest(shaft(TRUE_EI, (k, 0.0, 0.0), sensors=SENSORS), base).write_csv(files[-1])
    for mounting in (False, True):
        ran = palpate_program("identify", "registration", *files, "--catheter", stated, *["--mounting"][:mounting],
                              "--out", tmp_path / "theirs.toml")
        assert ran.returncode == 0, ran.stderr
        catheter = palpate.Catheter.from_toml(stated)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", palpate.PalpateWarning)
            found = palpate.identify_registration(catheter, [palpate.read_recording(file) for file in files],
                                                  mounting=mounting)
        found.write(stated, tmp_path / "ours.toml")
        assert written(tmp_path / "ours.toml") == written(tmp_path / "theirs.toml")
        assert written(tmp_path / "ours.toml").startswith("# kept\n")
        np.testing.assert_allclose(palpate.Catheter.from_toml(tmp_path / "ours.toml").T_tracker_base.p, base.p, atol=1e-5)


def test_arc_of_markers_that_were_not_seen():
    """A row of NaN is left out; a column was not measured; a hole in a row is refused."""
    places = np.linspace(0.01, LENGTH, 8)
    points = palpate.solve(shaft(TRUE_EI, (24.0, -3.0, 0.0)), arc_lengths_m=places).position_base_m
    points += 1e-5 * np.random.default_rng(3).normal(size=points.shape)
    seen = np.array([0, 1, 3, 4, 5, 7])
    few = points.copy()
    few[[2, 6]] = np.nan
    with pytest.warns(palpate.PalpateWarning):
        ours, theirs, all_of_them = (palpate.fit_arc(shaft(TRUE_EI), data) for data in
                                     ((places, few), (places[seen], points[seen]), (places, points)))
    np.testing.assert_array_equal(ours.precurvature_per_m, theirs.precurvature_per_m)
    assert ours.degrees_of_freedom == theirs.degrees_of_freedom == all_of_them.degrees_of_freedom - 6
    from_one_side = points.copy()
    from_one_side[:, 0] = np.nan
    with pytest.warns(palpate.PalpateWarning):
        fit = palpate.fit_arc(shaft(TRUE_EI), (places, from_one_side))
    assert fit.told == [True, False, False] and abs(fit.precurvature_per_m[0] - 24.0) < 0.1
    few[3, 1] = np.nan
    with pytest.raises(palpate.InputError, match="expected the same components"):
        palpate.fit_arc(shaft(TRUE_EI), (places, few))
    with pytest.raises(palpate.InputError, match="expected"):
        palpate.fit_arc(shaft(TRUE_EI), (places, np.full((8, 3), np.nan)))


def test_arc():
    points = palpate.solve(shaft(TRUE_EI, (24.0, -3.0, 0.0)), arc_lengths_m=PLACES).position_base_m
    fit = palpate.fit_arc(shaft(TRUE_EI), (PLACES, points), sigma_m=1e-4)
    np.testing.assert_allclose(fit.precurvature_per_m[:2], [24.0, -3.0], atol=1e-3)
    assert fit.converged and fit.told == [True, True, False] and fit.rms_m < 1e-7
    points[:, 0] = np.nan  # a picture from the side
    again = palpate.fit_arc(shaft(TRUE_EI), (PLACES, points))
    assert again.told[0] and again.precurvature_per_m[0] == pytest.approx(24.0, abs=1.0)


def at_rest(catheter, base, frames=20):
    """A recording of the unloaded shaft as a tracker at `base` sees it, without noise."""
    names = [sensor.name for sensor in catheter.sensors]
    shape = palpate.solve(catheter, arc_lengths_m=[sensor.arc_length_m for sensor in catheter.sensors])
    sensors = {}
    for name, position, R in zip(names, shape.position_base_m, shape.R_base_local):
        pose = base @ palpate.Pose(R, position)
        sensors[name] = (np.tile(pose.p, (frames, 1)), np.tile(quaternion_of(pose.R), (frames, 1)))
    return palpate.Recording(0.025 * np.arange(frames), sensors)


def quaternion_of(R):
    """By the eigenvector of the largest eigenvalue (Bar-Itzhack 2000)."""
    xx, xy, xz, yx, yy, yz, zx, zy, zz = R.ravel()
    K = np.array([[xx - yy - zz, 0, 0, 0], [yx + xy, yy - xx - zz, 0, 0], [zx + xz, zy + yz, zz - xx - yy, 0],
                  [zy - yz, xz - zx, yx - xy, xx + yy + zz]]) / 3.0
    x, y, z, w = np.linalg.eigh(K)[1][:, -1]
    return np.array([w, x, y, z])


SENSORS = [palpate.Sensor("tip", arc_length_m=LENGTH), palpate.Sensor("shaft", arc_length_m=0.04)]
TURN = np.array([[0.0, -1.0, 0.0], [0.6, 0.0, -0.8], [0.8, 0.0, 0.6]])


def test_registration():
    base = palpate.Pose(TURN, [0.1, -0.05, 0.2])
    recordings = [at_rest(shaft(TRUE_EI, (k, 0.0, 0.0), sensors=SENSORS), base) for k in (5.0, 20.0, 40.0)]
    found = palpate.identify_registration(shaft(TRUE_EI, sensors=SENSORS), [recordings[0], (recordings[1], (0.0, 0.3)),
                                                                           recordings[2]])
    np.testing.assert_allclose(found.T_reference_base.p, base.p, atol=1e-5)
    np.testing.assert_allclose(found.T_reference_base.R, base.R, atol=1e-4)
    np.testing.assert_allclose(found.precurvature_per_m[:, 0], [5.0, 20.0, 40.0], atol=0.05)
    np.testing.assert_allclose(found.catheter.T_tracker_base.p, base.p, atol=1e-5)
    assert found.base_covariance.shape == (6, 6)


def test_arc_of_a_recording():
    base = palpate.Pose(TURN, [0.1, -0.05, 0.2])
    recording = at_rest(shaft(TRUE_EI, (24.0, -3.0, 0.0), sensors=SENSORS), base)
    fit = palpate.fit_arc(shaft(TRUE_EI, sensors=SENSORS, base=base), recording, interval=(0.0, 0.4), clamp="exact")
    np.testing.assert_allclose(fit.precurvature_per_m, [24.0, -3.0, 0.0], atol=0.01)


def test_noise_at_rest():
    random = np.random.default_rng(3)
    n, sigma_m, sigma_rad = 2000, 0.2e-3, 2e-3
    half = 0.5 * sigma_rad * random.normal(size=(n, 3))
    quaternion = np.column_stack([np.sqrt(1.0 - (half**2).sum(axis=1)), half])
    position = [0.1, 0.2, 0.3] + sigma_m * random.normal(size=(n, 3))
    recording = palpate.Recording(0.025 * np.arange(n), {"tip": (position, quaternion)})
    found = palpate.identify_rest_noise(recording)["tip"]
    assert found.untold == "" and found.rest == "still"
    np.testing.assert_allclose(np.sqrt(np.diag(found.covariance)), [sigma_m] * 3 + [sigma_rad] * 3, rtol=0.1)
    few = palpate.identify_rest_noise(recording, interval=(0.0, 0.1))["tip"]
    assert few.untold


def test_noise_of_motion():
    random = np.random.default_rng(4)
    n, sigma_m = 1200, 0.2e-3
    t = 0.025 * np.arange(n)
    course = 0.01 * np.column_stack([np.sin(1.1 * t), np.cos(0.8 * t), np.sin(0.5 * t)])
    recording = palpate.Recording(t, {"tip": (course + sigma_m * random.normal(size=(n, 3)), None)})
    found = palpate.identify_moving_noise(recording)["tip"]
    assert found.holds
    np.testing.assert_allclose(found.sigma[:3], sigma_m, rtol=0.1)


def test_delay(heartbeat, tmp_path):
    truth = palpate.read_forces(heartbeat.truth)
    truth["time_s"] -= 0.04  # the tracker's stamps are later
    smooth = palpate.estimate(heartbeat.recording, heartbeat.catheter, smooth=True)
    fit = palpate.identify_delay(smooth, truth)
    assert abs(fit.delay_s - 0.04) < 0.01 and fit.explained > 0.9
    ran = palpate_program("identify", "delay", "--catheter", heartbeat.toml, heartbeat.recording, "--truth", heartbeat.truth,
                          "--json")
    assert ran.returncode == 0, ran.stderr
    theirs = json.loads(ran.stdout)["delay_s"]
    assert palpate.identify_delay(smooth, heartbeat.truth).delay_s == pytest.approx(theirs, abs=1e-4)
