# SPDX-License-Identifier: Apache-2.0
"""A catheter by keywords is the one of its file, and says itself as a file again."""

import numpy as np
import pytest
from conftest import ROOT
from test_bad_input import GOOD, refused

import palpate

# Everything that a file and keywords can both say, each number other than its default.
FILE = """schema = 1
[catheter]
name = "a \\"b\\" \\\\ c"
length_mm = 70.3
bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]
poisson_ratio = 0.31
stiffness_sigma_percent = 7.7
stiffness_correlation = 0.83
precurvature_per_m = [12.7, -3.1, 0.4]
precurvature_sigma_per_m = [0.5, 0.6, 0.2]
shear_stiffness_N = 812.5
axial_stiffness_N = 2500.1
weight_N_per_m = 0.09
rigid_tip_mm = 4.1
[[catheter.section]]
from_mm = 10.1
to_mm = 20.3
rigid = true
precurvature_per_m = [1.0, 2.0, 3.0]
[[catheter.section]]
from_mm = 50.7
to_mm = 70.3
bending_stiffness_Nm2 = [0.9e-3, 0.8e-3]
torsional_stiffness_Nm2 = 0.77e-3
[gravity]
direction_in_base = [0.0, 1.0, 0.0]
[tendon]
model = "end_moment"
offset_mm = 0.83
moment_sigma_percent = 3.3
[base]
sensor = "clamp"
mount_position_mm = [1.1, -2.3, 3.7]
noise_mm = 0.11
noise_deg = 0.07
position_sigma_mm = 0.37
rotation_sigma_deg = 0.23
[[sensor]]
name = "tip"
kind = "pose5"
arc_length_mm = 70.3
mount_quaternion_wxyz = [0.5, 0.5, 0.5, 0.5]
mount_sigma_mm = 0.19
noise_axes_mm = [0.1, 0.2, 0.3]
noise_deg = 0.17
bias_mm = 0.9
bias_deg = 0.7
delay_s = 0.013
[[sensor]]
name = "dot"
kind = "position"
arc_length_mm = 33.3
base_quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]
base_position_mm = [10.1, 20.2, 30.3]
markers = ["m1", "m2"]
[tracker]
bias_length_mm = 71.0
bias_memory_s = 33.0
[recording]
ignore_sensors = ["reference"]
[estimator]
method = "iaekf"
state = ["force", "stiffness"]
adaptation_window = 21
stiffness_rate_percent_per_s = 0.7
"""

MM, DEG = 1e-3, np.pi / 180.0
QUARTER = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # quaternion (1, 1, 1, 1) / 2


def by_keywords():
    return palpate.Catheter(
        name='a "b" \\ c', length_m=70.3 * MM, bending_stiffness_Nm2=(0.2612e-3, 0.16664e-3), poisson_ratio=0.31,
        stiffness_sigma_fraction=0.077, stiffness_correlation=0.83, precurvature_per_m=(12.7, -3.1, 0.4),
        precurvature_sigma_per_m=(0.5, 0.6, 0.2), shear_stiffness_N=812.5, axial_stiffness_N=2500.1,
        distributed_load_base_N_per_m=(0.0, 0.09, 0.0), rigid_tip_m=4.1 * MM,
        sections=[palpate.Section(10.1 * MM, 20.3 * MM, rigid=True, precurvature_per_m=(1.0, 2.0, 3.0)),
                  palpate.Section(50.7 * MM, 70.3 * MM, bending_stiffness_Nm2=(0.9e-3, 0.8e-3),
                                  torsional_stiffness_Nm2=0.77e-3)],
        tendon="end_moment", tendon_offset_m=0.83 * MM, tendon_moment_sigma_fraction=0.033,
        base_sensor=palpate.Sensor("clamp", T_local_sensor=palpate.Pose(p=[1.1 * MM, -2.3 * MM, 3.7 * MM]),
                                   noise_m=0.11 * MM, noise_rad=0.07 * DEG),
        base_position_sigma_m=0.37 * MM, base_rotation_sigma_rad=0.23 * DEG,
        sensors=[palpate.Sensor("tip", "pose5", 70.3 * MM, (0.1 * MM, 0.2 * MM, 0.3 * MM), 0.17 * DEG,
                                T_local_sensor=palpate.Pose(QUARTER), mount_sigma_m=0.19 * MM, bias_m=0.9 * MM,
                                bias_rad=0.7 * DEG, delay_s=0.013),
                 palpate.Sensor("dot", "position", 33.3 * MM, markers=["m1", "m2"],
                                T_tracker_base=palpate.Pose(p=[10.1 * MM, 20.2 * MM, 30.3 * MM]))],
        bias_length_m=0.071, bias_memory_s=33.0, ignore_sensors=["reference"],
        observer_options={"method": "iaekf", "state": ["force", "stiffness"], "adaptation_window": 21,
                          "stiffness_rate_per_s": 0.007})


def flat(thing):
    """All that an object of ours says, by name."""
    if isinstance(thing, (palpate.Catheter, palpate.Sensor, palpate.Section, palpate.Pose)):
        names = [name for name in dir(type(thing)) if isinstance(getattr(type(thing), name), property)]
        return {f"{name}{rest}": value for name in names for rest, value in flat(getattr(thing, name)).items()}
    if isinstance(thing, list) and thing and not isinstance(thing[0], str):
        return {f"[{i}]{rest}": value for i, one in enumerate(thing) for rest, value in flat(one).items()}
    if isinstance(thing, dict):
        return {f".{name}": value for name, value in thing.items()}
    return {"": thing}


def same(a, b, rtol):
    a, b = flat(a), flat(b)
    assert a.keys() == b.keys() and len(a) > 60
    for name, value in a.items():
        if isinstance(value, (float, np.ndarray)):
            np.testing.assert_allclose(b[name], value, rtol=rtol, atol=rtol, err_msg=name)
        else:
            assert b[name] == value, name


def test_keywords_say_what_a_file_says():
    same(palpate.Catheter.from_text(FILE), by_keywords(), rtol=1e-14)


def alike(a, b):
    a, b = flat(a), flat(b)
    return {name for name in a.keys() & b.keys() if np.array_equal(a[name], b[name])}


def test_nothing_of_it_is_left_at_its_default():
    """Else test_keywords_say_what_a_file_says would not see a keyword that does nothing."""
    told = by_keywords()
    elsewhere = ("observer_options", "sensors[", "sections[0]", "T_tracker_base", "warnings")
    assert not [name for name in alike(palpate.Catheter(**GOOD), told) if not name.startswith(elsewhere)]
    plain = palpate.Sensor("")
    assert not set.intersection(*(alike(plain, sensor) for sensor in [*told.sensors, told.base_sensor]))


@pytest.mark.parametrize("file", [FILE, *sorted((ROOT / "examples").glob("**/*catheter*.toml"))], ids=str)
def test_round_trip(file):
    catheter = palpate.Catheter.from_text(file) if file is FILE else palpate.Catheter.from_toml(file)
    text = catheter.to_toml()
    back = palpate.Catheter.from_text(text)
    same(catheter, back, rtol=1e-15)
    assert palpate.Catheter.from_text(back.to_toml()).to_toml() == text
    assert back.length_m == catheter.length_m and back.sensors[-1].arc_length_m == catheter.sensors[-1].arc_length_m


def test_numbers_of_a_file_come_back_to_the_last_bit():
    """What came of a product with a unit has a factor: 800 in millimetres, degrees and percent, of 1 to 17 digits."""
    random = np.random.default_rng(5)
    for _ in range(20):
        mm, deg, percent = (f"{value:.{digits}g}" for value, digits in zip(random.uniform(0.1, 9.0, 3), (17, 9, 6)))
        head = f"""[catheter]
length_mm = 70.3
bending_stiffness_Nm2 = [2e-4, 2e-4]
torsional_stiffness_Nm2 = 1e-4
stiffness_sigma_percent = {percent}
contact_offset_mm = [{mm}, 0.0, 1.0]
[base]
quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]
position_mm = {[float(value) for value in random.normal(0.0, 200.0, 3).round(3)]}
rotation_sigma_deg = {deg}
"""
        sensors = [f"[[sensor]]\nname = \"s{i}\"\narc_length_mm = {70 * a:.{i + 1}g}\nnoise_mm = {b}\nnoise_deg = {c}\n"
                   f"bias_mm = {d:.3g}\n" for i, (a, b, c, d) in enumerate(random.uniform(0.02, 1.0, (8, 4)))]
        catheter = palpate.Catheter.from_text(head + "".join(sensors))
        ours, theirs = flat(palpate.Catheter.from_text(catheter.to_toml())), flat(catheter)
        assert [name for name in theirs if not np.array_equal(ours[name], theirs[name])] == []


def test_round_trip_of_what_only_a_file_says():
    only = FILE.replace('[tendon]', '[ignored]').split("[ignored]")[0] + """[tendon_map]
input = "displacement_mm"
position = [0.0, 1.3, 2.9]
pull_k1_per_m = [0.0, 10.1, 20.3]
release_k1_per_m = [1.0, 12.1, 20.3]
sigma_per_m = [0.3, 0.1]
[base]
quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]
position_mm = [0.0, 0.0, 0.0]
[[sensor]]
name = "tip"
arc_length_mm = 70.3
[reference]
from_s = 0.1
to_s = 2.3
shape = "straight"
[[known_load]]
from_s = 3.0
to_s = 4.7
force_base_N = [0.0, 0.1, 0.2]
sigma_N = 0.011
"""
    text = palpate.Catheter.from_text(only).to_toml()
    assert palpate.Catheter.from_text(text).to_toml() == text
    for line in ('input = "displacement_mm"', "position = [0.0, 1.3, 2.9]", "pull_k1_per_m = [0.0, 10.1, 20.3]",
                 "release_k2_per_m = [-3.1, -3.1, -3.1]", "sigma_per_m = [0.3, 0.1]", "to_s = 2.3", 'shape = "straight"',
                 "force_base_N = [0.0, 0.1, 0.2]", "sigma_N = 0.011"):
        assert f"\n{line}\n" in text


def test_round_trip_gives_the_same_forces(heartbeat):
    """The base's rotation comes back to 1e-16; a force that is held against it in millinewtons per degree, to 1e-10."""
    catheter = heartbeat.catheter
    again = palpate.Catheter.from_text(catheter.to_toml())
    ours, theirs = (palpate.estimate(heartbeat.recording, one).force_tip_N for one in (again, catheter))
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-10)


def test_the_force_acts_at_the_end_of_the_rigid_tip():
    """As a catheter file has it (docs/reference/formats.md)."""
    np.testing.assert_array_equal(palpate.Catheter(**GOOD, rigid_tip_m=0.004).contact_offset_m, [0.0, 0.0, 0.004])
    here = palpate.Catheter(**GOOD, rigid_tip_m=0.004, contact_offset_m=(0.0, 0.0, 0.0))
    np.testing.assert_array_equal(here.contact_offset_m, [0.0, 0.0, 0.0])


def test_round_shaft():
    """EI = E pi d^4 / 64, GJ = EI / (1 + nu)."""
    told = {key: value for key, value in GOOD.items() if "stiffness" not in key}
    shaft = palpate.Catheter(**told, youngs_modulus_Pa=60e6, diameter_m=2.3e-3, poisson_ratio=0.4)
    EI = 60e6 * np.pi * 2.3e-3**4 / 64.0
    np.testing.assert_allclose([*shaft.bending_stiffness_Nm2, shaft.torsional_stiffness_Nm2], [EI, EI, EI / 1.4], rtol=1e-14)


@pytest.mark.parametrize("keywords, name", [
    ({"sections": 5}, "sections"), ({"sections": [palpate.Pose()]}, "sections"), ({"base": "origin"}, "base"),
    ({"sections": [palpate.Section(0.02, 0.01)]}, "sections[0].to_m"),
    ({"sections": [palpate.Section(0.0, 0.08)]}, "sections[0].to_m"),
    ({"sections": [palpate.Section(0.0, 0.03), palpate.Section(0.02, 0.05)]}, "sections[1].from_m"),
    ({"tendon": "wire"}, "tendon"), ({"tendon": 1}, "tendon"), ({"tendon_offset_m": 0.001}, "tendon_offset_m"),
    ({"base": palpate.Pose(), "base_sensor": palpate.Sensor("b")}, "base"), ({"base_sensor": palpate.Pose()}, "base_sensor"),
    ({"base_sensor": palpate.Sensor("tip")}, "tip"), ({"poisson_ratio": 0.3}, "poisson_ratio"),
    ({"youngs_modulus_Pa": 6e7}, "bending_stiffness_Nm2"), ({"shear_stiffness_N": 5.0}, "shear_stiffness_N"),
    ({"stiffness_correlation": 1.0}, "stiffness_correlation"), ({"bias_memory_s": 0.0}, "bias_memory_s"),
    ({"ignore_sensors": [5]}, "ignore_sensors"), ({"observer_options": {"metod": "ekf"}}, "method"),
    ({"observer_options": 5}, "observer_options"), ({"rigid_tip_mm": 4.0}, "rigid_tip_m")], ids=str)
def test_bad_keywords(keywords, name):
    assert "expected" in refused(name, palpate.Catheter, **{**GOOD, **keywords})


@pytest.mark.parametrize("missing", ["length_m", "bending_stiffness_Nm2", "torsional_stiffness_Nm2", "sensors"])
def test_missing_keywords(missing):
    with pytest.raises(TypeError, match=missing):
        palpate.Catheter(**{key: value for key, value in GOOD.items() if key != missing})


@pytest.mark.parametrize("key, bad", [("from_m", "0"), ("to_m", float("nan")), ("rigid", 1), ("precurvature_per_m", 3.0),
                                      ("bending_stiffness_Nm2", (1.0, 2.0, 3.0))])
def test_bad_section(key, bad):
    refused(key, palpate.Section, **{"from_m": 0.0, "to_m": 0.01, key: bad})


def test_what_no_file_may_say():
    with pytest.raises(palpate.InputError, match="length_mm = 0.5: expected a length in mm"):
        palpate.Catheter(**{**GOOD, "length_m": 0.0005, "sensors": [palpate.Sensor("tip")]}).to_toml()
