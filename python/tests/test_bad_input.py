# SPDX-License-Identifier: Apache-2.0
"""Whatever comes in: an exception that names the argument, never a crash."""

import numpy as np
import pytest
from conftest import palpate_program

import palpate

NAN, INF = float("nan"), float("inf")
NOT_VECTORS = [
    [0.0, 0.1], [0.0, 0.1, 0.2, 0.3], 0.1, [[0.0, 0.1, 0.2]], [], "0.1", ["0.1", "0.2", "0.3"], b"123", None, {}, {"x": 1.0},
    object(), [0.0, 0.1, None], [0.0, [0.1], 0.2], [NAN, 0.0, 0.0], [0.0, INF, 0.0], [1j, 0.0, 0.0], [True, False, True],
    np.array(["a", "b", "c"]), np.array([0, 0, 0], "M8[s]"), np.array([1, 2, 3], object),
    np.ma.masked_array([1.0, 2.0, 3.0], [0, 1, 0]), np.zeros(3, [("x", "f8")]), np.zeros((3, 0)), lambda: 0,
]


def ids(values):
    return [f"{type(value).__name__}-{i}" for i, value in enumerate(values)]


def refused(name, call, /, *arguments, **keywords):
    with pytest.raises((palpate.InputError, TypeError)) as caught:
        call(*arguments, **keywords)
    message = str(caught.value)
    assert name in message
    assert "\n" not in message
    return message


@pytest.mark.parametrize("bad", NOT_VECTORS, ids=ids(NOT_VECTORS))
def test_vector(paper, bad):
    message = refused("force_tip_N", palpate.solve, paper, bad)
    assert "expected" in message


@pytest.mark.parametrize("bad", [*NOT_VECTORS[:3], *NOT_VECTORS[4:], np.zeros((4, 2)), np.zeros((2, 3, 1)), [[NAN, 0.0, 0.0]]])
def test_rows_of_vectors(paper, bad):
    assert "expected" in refused("forces_tip_N", palpate.solve_batch, paper, bad)


def test_the_entry_is_named(paper):
    forces = np.zeros((20, 3))
    forces[17, 1] = NAN
    assert refused("forces_tip_N", palpate.solve_batch, paper, forces) == \
        "forces_tip_N[17, 1] = nan: expected a finite number"
    assert refused("force_tip_N", palpate.solve, paper, [1.0, 2.0]) == "force_tip_N: shape (2,): expected shape (3,)"
    assert refused("moments_tip_Nm", palpate.solve_batch, paper, forces[:3], moments_tip_Nm=forces[:2]) == \
        "moments_tip_Nm: shape (2, 3): expected shape (3, 3)"


@pytest.mark.parametrize("bad", [[-0.01], [0.08], [NAN], "0.01", [[0.01]], {"s": 1}])
def test_places(paper, bad):
    refused("arc_lengths_m", palpate.solve, paper, arc_lengths_m=bad)
    refused("arc_lengths_m", palpate.solve_batch, paper, np.zeros((2, 3)), arc_lengths_m=bad)


@pytest.mark.parametrize("size", [1e3, 1e10, 1e100, 1e300])
def test_huge_forces_end(paper, size):
    """No such force bends a shaft: what comes out is not a number or a coil, but it comes out."""
    assert palpate.solve(paper, [size, 0.0, 0.0]).position_base_m.shape == (51, 3)
    assert palpate.solve_batch(paper, [[size, 0.0, 0.0]] * 3).tip.position_base_m.shape == (3, 3)


@pytest.mark.parametrize("workers", [-1, 1.5, "2", None, True, 10**30, np.array([1, 2]), np.array(2.0), [2]])
def test_workers(paper, workers):
    refused("workers", palpate.solve_batch, paper, np.zeros((2, 3)), workers=workers)


NOT_CATHETERS = [None, 5, "catheter.toml", {}, palpate.Pose()]


@pytest.mark.parametrize("bad", NOT_CATHETERS, ids=ids(NOT_CATHETERS))
def test_catheter(bad, heartbeat):
    refused("catheter", palpate.solve, bad)
    refused("catheter", palpate.solve_batch, bad, np.zeros((2, 3)))
    refused("catheter", palpate.ForceObserver, bad)
    refused("catheter", palpate.estimate, heartbeat.recording, bad)
    refused("catheter", palpate.fit_arc, bad, ([0.0], [[0.0, 0.0, 0.0]]))
    refused("catheter", palpate.identify_stiffness, bad, [])


GOOD = {"length_m": 0.07, "bending_stiffness_Nm2": (2e-4, 2e-4), "torsional_stiffness_Nm2": 1e-4,
        "sensors": [palpate.Sensor("tip", arc_length_m=0.07)]}


@pytest.mark.parametrize("key, bad", [
    ("length_m", "0.07"), ("length_m", NAN), ("length_m", True), ("length_m", [0.07]), ("bending_stiffness_Nm2", 2e-4),
    ("bending_stiffness_Nm2", (1.0, 2.0, 3.0)), ("bending_stiffness_Nm2", "ab"), ("torsional_stiffness_Nm2", None),
    ("precurvature_per_m", 20.0), ("precurvature_per_m", (NAN, 0.0, 0.0)), ("name", 5), ("rigid_tip_m", INF),
    ("stiffness_sigma_fraction", -0.1), ("base_position_sigma_m", -1.0), ("contact_offset_m", "abc")])
def test_catheter_by_keywords(key, bad):
    refused(key.removeprefix("base_"), palpate.Catheter, **{**GOOD, key: bad})


def test_catheter_needs_sense():
    for spoiled in ({"length_m": -0.07}, {"length_m": 0.0}, {"bending_stiffness_Nm2": (0.0, 1e-4)}, {"sensors": []},
                    {"torsional_stiffness_Nm2": -1.0}, {"sensors": [palpate.Sensor("tip", arc_length_m=0.08)]},
                    {"sensors": [palpate.Sensor("tip"), palpate.Sensor("tip")]},
                    {"sensors": [palpate.Sensor(f"s{i}", arc_length_m=0.001 * i) for i in range(9)]}):
        with pytest.raises(palpate.InputError, match="expected"):
            palpate.Catheter(**{**GOOD, **spoiled})
    with pytest.raises(TypeError):
        palpate.Catheter(**GOOD, lenght_m=0.07)
    with pytest.raises(TypeError):
        palpate.Catheter(**{**GOOD, "sensors": "tip"})


@pytest.mark.parametrize("key, bad", [("name", 5), ("kind", "poes"), ("kind", 6), ("arc_length_m", "70"),
                                      ("noise_m", "abc"), ("noise_m", (1.0, 2.0)), ("noise_rad", NAN), ("bias_m", [])])
def test_sensor(key, bad):
    refused(key, palpate.Sensor, **{"name": "tip", key: bad})


def test_parts_of_a_catheter_by_wrong_names():
    """In words, as Catheter has them: never a list of C++ signatures."""
    for kind, good, typo, meant in ((palpate.Sensor, {"name": "tip"}, "arclength_m", "arc_length_m"),
                                    (palpate.Section, {"from_m": 0.0, "to_m": 0.1}, "precurvature", "precurvature_per_m")):
        message = refused(typo, kind, **good, **{typo: 1.0})
        assert message.startswith(f"{kind.__name__}: keyword '{typo}': expected") and f"is '{meant}' meant?" in message
        first = next(iter(good))
        assert f"{kind.__name__}: {first}: not given" in refused(first, kind, **{k: v for k, v in good.items() if k != first})
        assert "by place" in refused(kind.__name__, kind, *range(12))
        assert "by place" in refused(kind.__name__, kind, *good.values(), **good)
    assert "is 'R' meant?" in refused("keyword 'r'", palpate.Pose, r=np.eye(3))
    assert "3 arguments by place" in refused("Pose", palpate.Pose, np.eye(3), np.zeros(3), 5)
    assert "1 arguments by place" in refused("Catheter", palpate.Catheter, "catheter.toml")
    for name in ("T_local_sensor", "T_tracker_base"):
        for bad in (np.eye(4), 5, "pose"):
            message = refused(name, palpate.Sensor, "tip", **{name: bad})
            assert message == f"{name}: {type(bad).__name__}: expected palpate.Pose"
    for bad in ("abc", 5, [5], b"abc"):
        assert "expected a" in refused("markers", palpate.Sensor, "tip", markers=bad)


def test_pose():
    assert "rotation" in refused("R", palpate.Pose, R=np.ones((3, 3)))
    refused("R", palpate.Pose, R=np.eye(4))
    refused("R", palpate.Pose, R=-np.eye(3))
    refused("p", palpate.Pose, p=[1.0, 2.0])


@pytest.mark.parametrize("options, name", [
    ({"methd": "ekf"}, "methd"), ({"method": "kalman"}, "method"), ({"method": 5}, "method"), ({"state": "force"}, "state"),
    ({"state": ["torque"]}, "state"), ({"state": [5]}, "state"), ({"max_iterations": 0}, "max_iterations"),
    ({"max_iterations": 2.5}, "max_iterations"), ({"max_iterations": 10**12}, "max_iterations"),
    ({"consider_uncertainty": 1}, "consider_uncertainty"), ({"initial_force_sigma_N": -1.0}, "initial_force_sigma_N"),
    ({"initial_force_sigma_N": "1"}, "initial_force_sigma_N"), ({"forecast_s": NAN}, "forecast_s")])
def test_options(paper, heartbeat, options, name):
    assert "expected" in refused(name, palpate.ForceObserver, paper, **options)
    assert "expected" in refused(name, palpate.estimate, heartbeat.recording, heartbeat.catheter, **options)


@pytest.mark.parametrize("keywords, name", [
    ({"position_m": np.zeros((3, 3))}, "position_m"), ({"position_m": np.zeros((2, 4))}, "position_m"),
    ({"position_m": np.zeros(6)}, "position_m"), ({"position_m": "here"}, "position_m"), ({"position_m": None}, "position_m"),
    ({"position_m": np.zeros((2, 3), object)}, "position_m"), ({"quaternion_wxyz": np.zeros((2, 3))}, "quaternion_wxyz"),
    ({"quaternion_wxyz": np.zeros((3, 4))}, "quaternion_wxyz"), ({"quaternion_wxyz": "abcd"}, "quaternion_wxyz"),
    ({"time_s": "now"}, "time_s"), ({"time_s": [0.0]}, "time_s"), ({"time_s": None}, "time_s"),
    ({"tendon_moment_Nm": [0.0, 0.0]}, "tendon_moment_Nm")])
def test_update(paper, keywords, name):
    observer = palpate.ForceObserver(paper)
    good = {"time_s": 0.0, "position_m": np.full((2, 3), 0.01), "quaternion_wxyz": [[1.0, 0.0, 0.0, 0.0]] * 2}
    assert "expected" in refused(name, observer.update, **{**good, **keywords})
    refused("frame", observer.update_frame, {"time_s": 0.0})
    refused("ahead_s", observer.forecast, -1.0)
    refused("ahead_s", observer.forecast, "soon")


def test_frame_of_another_catheter(paper):
    recording = palpate.Recording([0.0], {"tip": (np.zeros((1, 3)), None)})
    assert "tip, shaft" in refused("frame", palpate.ForceObserver(paper).update_frame, recording[0])


def test_recording_from_arrays():
    zeros = np.zeros((4, 3))
    refused("position_m", palpate.Recording, np.arange(4.0), {"tip": (zeros[:3], None)})
    refused("quaternion_wxyz", palpate.Recording, np.arange(4.0), {"tip": (zeros, zeros)})
    refused("time_s", palpate.Recording, "0123", {"tip": (zeros, None)})
    refused("sensors", palpate.Recording, np.arange(4.0), {"tip": zeros})
    refused("sensors", palpate.Recording, np.arange(4.0), {5: (zeros, None)})
    refused("sensors", palpate.Recording, np.arange(4.0), [("tip", zeros)])
    refused("source", palpate.Recording, np.arange(4.0), {}, source=5)
    with pytest.raises(KeyError, match="tip"):
        palpate.Recording(np.arange(4.0), {"tip": (zeros, None)})["tpi"]
    with pytest.raises(IndexError):
        palpate.Recording(np.arange(4.0), {"tip": (zeros, None)})[4]


def test_truth_and_estimate(paper):
    rows = np.zeros(3, [("time_s", "f8"), ("force_tip_N", "f8", 3)])
    rows["time_s"] = [0.0, 2.0, 1.0]
    recording = palpate.Recording(np.arange(0.0, 2.0, 0.025), {
        name: (np.full((80, 3), NAN), np.full((80, 4), NAN)) for name in ("tip", "shaft")})
    estimates = palpate.estimate(recording, paper)
    assert set(estimates.status) == {"HELD"}
    assert "truth.time_s[2]" in refused("truth", palpate.evaluate, estimates, rows)
    refused("truth", palpate.evaluate, estimates, np.zeros((3, 4)))
    refused("truth", palpate.evaluate, estimates, 5)
    refused("truth", palpate.evaluate, estimates, rows[:0])
    refused("estimate", palpate.evaluate, rows, rows[:2])
    refused("skip_s", palpate.evaluate, estimates, rows[:2], skip_s="1")
    refused("estimate", palpate.identify_delay, 5, rows)
    for no_rows in (np.zeros(4), 5, rows, estimates.rows[0], estimates.rows.reshape(8, 10)):
        assert "expected a structured array" in refused("rows", palpate.Estimates, no_rows)
    estimates["status"][3] = "GUESSED"
    assert "'GUESSED': expected one of" in refused("estimate.status", palpate.evaluate, estimates, rows[:2])


@pytest.mark.parametrize("bad", [5, None, b"x", [], [5]])
def test_paths(paper, bad):
    refused("path", palpate.Catheter.from_toml, bad)
    refused("recording", palpate.read_recording, bad)
    refused("recording", palpate.estimate, bad, paper)
    refused("path", palpate.read_forces, bad)
    refused("scenario", palpate.simulate, bad)
    if isinstance(bad, bytes):
        assert "bytes: expected a path" in refused("recording", palpate.estimate, bad, paper)


def test_identification(paper):
    good = {"name": "a", "force_base_N": (0.1, 0.0, 0.0), "arc_length_m": [0.03, 0.07], "position_base_m": np.zeros((2, 3))}
    for key, bad in {"force_base_N": [1.0], "arc_length_m": "ab", "position_base_m": np.zeros((3, 3)), "sigma_m": -1.0}.items():
        refused(key, palpate.identify_stiffness, paper, [palpate.LoadCase(**{**good, key: bad})])
    refused("cases", palpate.identify_stiffness, paper, [good])
    refused("cases", palpate.identify_stiffness, paper, 5)
    refused("unknowns", palpate.identify_stiffness, paper, [palpate.LoadCase(**good)], unknowns="all")
    refused("data", palpate.fit_arc, paper, np.zeros((3, 3)))
    refused("position_m", palpate.fit_arc, paper, ([0.01, 0.02], np.zeros((3, 3))))
    refused("clamp", palpate.fit_arc, paper, ([0.01, 0.02], np.zeros((2, 3))), clamp="loose")
    refused("positions", palpate.identify_registration, paper, [5])
    refused("recording", palpate.identify_rest_noise, 5)
    with pytest.raises(palpate.InputError):
        palpate.identify_registration(paper, [])


@pytest.mark.parametrize("keywords", [{"seed": -1}, {"seed": 1.5}, {"seed": "1"}, {"seed": np.array([1, 2])}, {"duration_s": -1.0}, {"rate_hz": NAN},
                                      {"noise_free": 1}, {"stable_only": "no"}], ids=str)
def test_simulation(keywords):
    refused(next(iter(keywords)), palpate.simulate, "none.toml", **keywords)


def test_same_message_as_the_command_line(heartbeat, tmp_path):
    """A broken catheter, a broken row, a file that is not there, a recording of another catheter."""
    broken = tmp_path / "broken.toml"
    broken.write_text(heartbeat.toml.read_text().replace("length_mm = 70.0", "lenght_mm = 70.0"))
    lines = heartbeat.recording.read_text().splitlines()
    spoiled = tmp_path / "spoiled.csv"
    spoiled.write_text("\n".join([*lines[:5], lines[5].replace(",OK,", ",OKAY,"), *lines[6:]]))
    other = tmp_path / "other.toml"
    other.write_text(heartbeat.toml.read_text().replace('"shaft"', '"middle"'))
    cases = [(broken, heartbeat.recording), (heartbeat.toml, spoiled), (heartbeat.toml, tmp_path / "none.csv"),
             (tmp_path / "none.toml", heartbeat.recording), (other, heartbeat.recording)]
    for toml, recording in cases:
        ran = palpate_program("estimate", "--catheter", toml, recording, "--out", tmp_path / "e.csv")
        assert ran.returncode == 2
        with pytest.raises(palpate.InputError) as caught:
            palpate.estimate(recording, palpate.Catheter.from_toml(toml))
        assert ran.stderr.strip() == f"palpate: {caught.value}"


def test_files_of_another_encoding(tmp_path):
    """As a spreadsheet of 1998 writes them: what cannot be decoded is shown, and no message is lost."""
    toml, csv = tmp_path / "c.toml", tmp_path / "r.csv"
    toml.write_bytes("schema = 1\n[catheter]\nname = \"Prüfling\"\n".encode("latin-1"))
    csv.write_bytes("time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm\n0,1,Müll,OK,1,0,0,0,1,2,3,\n".encode("latin-1"))
    with pytest.raises(palpate.InputError, match=r"c.toml:3: line 'name = \"Pr\\xfcfling\"': expected TOML"):
        palpate.Catheter.from_toml(toml)
    recording = palpate.read_recording(csv)
    assert recording.sensor_names == ["M\\xfcll"] and len(recording["M\\xfcll"]) == 1
    assert list(palpate.identify_rest_noise(recording)) == recording.sensor_names


def test_input_error_is_a_value_error():
    assert issubclass(palpate.InputError, ValueError)
    assert palpate.InputError.__module__ == "palpate"
