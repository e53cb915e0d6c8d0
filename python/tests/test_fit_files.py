# SPDX-License-Identifier: Apache-2.0
"""Into which catheter file a fit may be written: that of the catheter to which it was made."""

import warnings

import numpy as np
import pytest
from conftest import ROOT
from test_identification import GUESS_EI, PLACES, TRUE_EI, TURN, at_rest, shaft

import palpate


def test_where_a_fit_is_not_written(tmp_path):
    folder = ROOT / "examples/stiffness"
    stated, out = folder / "catheter.toml", tmp_path / "out.toml"
    fit = palpate.identify_stiffness(palpate.Catheter.from_toml(stated), folder / "cases.toml")
    copy = tmp_path / "copy.toml"
    copy.write_text(stated.read_text())
    longer = tmp_path / "longer.toml"
    longer.write_text(palpate.Catheter.from_toml(stated).to_toml().replace('name = "', 'name = "other '))
    cases = {"out": (copy, copy), "none": (tmp_path / "none.toml", out), "empty": (copy, ""),
             "absent": (copy, tmp_path / "absent" / "out.toml"), "sensor \"tip\": name: ": (longer, out)}
    for what, (catheter, file) in cases.items():
        with pytest.raises(palpate.InputError, match={"empty": "out: expected the name of a file"}.get(what, what)):
            fit.write(catheter, file)
    for bad in (5, None, b"x"):
        with pytest.raises(palpate.InputError, match="catheter"):
            fit.write(bad, out)
    assert not out.exists() and copy.read_text() == stated.read_text()


MEANT = {
    "length_mm = 70.0": "length_mm: ", "precurvature_per_m = [20.0": "precurvature_per_m: ",
    "rigid_tip_mm = 1.0": "rigid_tip_mm: ", "contact_offset_mm = [0.0": "contact_offset_mm: ", "shear_stiffness_N = 300.0": "shear_stiffness_N: ",
    "axial_stiffness_N = 900.0": "axial_stiffness_N: ", "precurvature_sigma_per_m = [0.5": "precurvature_sigma_per_m: ",
    "arc_length_mm = 40.0": "sensor \"middle\": arc_length_mm: ", 'kind = "pose5"': "sensor \"middle\": kind: ",
    "torsional_stiffness_Nm2 = 0.00018": "stiffness: ", "position_sigma_mm = 0.3": "base: sigmas: ",
    "weight_N_per_m = 0.01": "weight_N_per_m or its direction: ", 'noise_mm = 0.2': "sensor \"middle\": noise: ",
    "position_mm = [100.0": "base: pose: "}
OTHER = {"length_mm = 70.0": "length_mm = 72.0", "precurvature_per_m = [20.0": "precurvature_per_m = [-20.0",
         'kind = "pose5"': 'kind = "pose"', "position_mm = [100.0": "position_mm = [101.0"}
BY_POSES_ALONE = ("noise_mm", "position_mm = ")  # of a list of points neither counts
BY_LOADS_ALONE = ("position_sigma", "position_mm = ")  # of the base that a registration replaces


def whole_shaft(tmp_path):
    """A catheter that has all of it, and its file."""
    sensors = [palpate.Sensor("middle", "pose5", 0.04, noise_m=0.2e-3), palpate.Sensor("tip", arc_length_m=0.07)]
    catheter = shaft(GUESS_EI, sensors=sensors, rigid_tip_m=1e-3, shear_stiffness_N=300.0, axial_stiffness_N=900.0,
                     distributed_load_base_N_per_m=(0.0, 0.01, 0.0), precurvature_sigma_per_m=(0.5, 0.5, 0.2),
                     base=palpate.Pose(p=[0.1, 0.0, 0.0]), base_position_sigma_m=0.3e-3, contact_offset_m=(0.0, 0.0, 5e-4))
    file = tmp_path / "stated.toml"
    file.write_text(catheter.to_toml(), encoding="utf-8")
    return catheter, file


def with_other(text, old):
    key, value = old.split(" = ")
    new = OTHER.get(old) or f"{key} = {'[' * value.startswith('[')}{float(value.strip('[')) * 1.5 + 0.1}"
    assert old in text and new != old
    return text.replace(old, new, 1)


def fits_of(catheter):
    cases = []
    for name, force in {"x": (0.02, 0.0, 0.0), "y": (0.0, 0.02, 0.0)}.items():
        shape = palpate.solve(catheter, force, arc_lengths_m=PLACES)
        cases.append(palpate.LoadCase(name, shape.T_base_tip.R @ force, PLACES, shape.position_base_m, sigma_m=1e-5))
    recordings = [at_rest(shaft(TRUE_EI, (k, 0.0, 0.0), sensors=catheter.sensors), palpate.Pose(TURN, [0.1, 0.0, 0.2]))
                  for k in (5.0, 20.0, 40.0)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", palpate.PalpateWarning)
        return palpate.identify_stiffness(catheter, cases), palpate.identify_registration(catheter, recordings)


def test_a_fit_goes_into_the_file_of_its_catheter_alone(tmp_path):
    catheter, stated = whole_shaft(tmp_path)
    stiffness, registration = fits_of(catheter)
    other, out = tmp_path / "other.toml", tmp_path / "out.toml"
    for fit, free in ((stiffness, BY_POSES_ALONE), (registration, BY_LOADS_ALONE)):
        fit.write(stated, out)
        out.unlink()
        for old, told in MEANT.items():
            other.write_text(with_other(stated.read_text(encoding="utf-8"), old), encoding="utf-8")
            if old.startswith(free):
                fit.write(other, out)
                out.unlink()
                continue
            with pytest.raises(palpate.InputError) as caught:
                fit.write(other, out)
            assert str(caught.value) == f"{other}: {told}expected as of the catheter to which the fit was made"
            assert not out.exists()


def test_a_file_of_loads_rests_on_the_sensors_too(tmp_path):
    """Its load cases may be recordings."""
    folder = ROOT / "examples/stiffness"
    stated = (folder / "catheter.toml").read_text(encoding="utf-8")
    fit = palpate.identify_stiffness(palpate.Catheter.from_toml(folder / "catheter.toml"), folder / "cases.toml")
    text = palpate.Catheter.from_text(stated).to_toml()
    other = tmp_path / "other.toml"
    other.write_text(text, encoding="utf-8")
    fit.write(other, tmp_path / "out.toml")
    noise = next(line for line in text.splitlines() if line.startswith("noise_mm"))
    other.write_text(text.replace(noise, "noise_mm = 7.0", 1), encoding="utf-8")
    with pytest.raises(palpate.InputError, match="noise: expected as of the catheter"):
        fit.write(other, tmp_path / "out.toml")


def test_what_a_fit_says_stays(tmp_path):
    """What is written is the fit's own: an edit of its arrays would be shown, and not be written."""
    for fit in fits_of(whole_shaft(tmp_path)[0]):
        arrays = [value for value in vars(fit).values() if isinstance(value, np.ndarray)]
        assert len(arrays) >= 2
        for array in arrays:
            with pytest.raises(ValueError, match="read-only"):
                array[...] = 0.0
