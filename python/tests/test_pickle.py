# SPDX-License-Identifier: Apache-2.0
"""What goes to another process and comes back, and what says that it does not."""

import copy
import pickle
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
from conftest import ROOT

import palpate
from palpate import _palpate

TURN = palpate.Pose([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [0.1, -0.2, 0.3])
PROTOCOLS = range(pickle.HIGHEST_PROTOCOL + 1)
WAYS = [*[lambda value, p=p: pickle.loads(pickle.dumps(value, p)) for p in PROTOCOLS], copy.copy, copy.deepcopy]
NAMES = [*[f"protocol {p}" for p in PROTOCOLS], "copy", "deepcopy"]


def fields(value):
    return {name: getattr(value, name) for name in dir(type(value)) if isinstance(getattr(type(value), name), property)}


def same(a, b):
    assert type(a) is type(b)
    if isinstance(a, (palpate.Pose, palpate.Sensor, palpate.Section)):
        for name, value in fields(a).items():
            same(value, getattr(b, name))
    elif isinstance(a, np.ndarray):
        np.testing.assert_array_equal(a, b)
    else:
        assert a == b


@pytest.mark.parametrize("way", WAYS, ids=NAMES)
@pytest.mark.parametrize("value", [
    palpate.Pose(), TURN, palpate.Section(0.01, 0.03), palpate.Section(0.01, 0.03, rigid=True),
    palpate.Section(0.0, 0.5, bending_stiffness_Nm2=(1e-4, 2e-4), torsional_stiffness_Nm2=3e-5, precurvature_per_m=(1, 2, 3)),
    palpate.Sensor("tip"),
    palpate.Sensor("Prüfling", "position", 0.0653, (1e-4, 2e-4, 3e-4), 0.01, T_local_sensor=TURN, mount_sigma_m=1e-3,
                   bias_m=4e-4, bias_rad=0.02, delay_s=0.03, T_tracker_base=TURN, markers=["a", "b"])], ids=repr)
def test_parts(way, value):
    same(value, way(value))


@pytest.mark.parametrize("way", WAYS, ids=NAMES)
@pytest.mark.parametrize("file", ["paper_catheter.toml", "soft_beam/soft_beam.toml", "stiffness/catheter.toml"])
def test_catheter(way, file):
    catheter = palpate.Catheter.from_toml(ROOT / "examples" / file)
    again = way(catheter)
    assert again.to_toml() == catheter.to_toml() and again.warnings == catheter.warnings
    assert again.observer_options == catheter.observer_options
    np.testing.assert_allclose(again.T_tracker_base.R, catheter.T_tracker_base.R, atol=1e-15)


def test_what_a_file_does_not_say():
    """Options of a run; a base whose position and rotation are known together, as after a tare: the same estimates."""
    catheter = palpate.Catheter(
        length_m=0.07, bending_stiffness_Nm2=(2e-4, 2e-4), torsional_stiffness_Nm2=1e-4, precurvature_per_m=(20.0, 0.0, 0.0),
        precurvature_sigma_per_m=(0.5, 0.5, 0.2), base_position_sigma_m=1e-3, base_rotation_sigma_rad=0.02,
        sensors=[palpate.Sensor(name, "position", s, 1e-4) for name, s in (("shaft", 0.05), ("tip", 0.07))])
    places = palpate.solve(catheter, arc_lengths_m=[0.05, 0.07]).position_base_m
    times = np.arange(0.0, 1.0, 0.025)
    rest = palpate.Recording(times, {name: (np.tile(place, (len(times), 1)), None)
                                     for name, place in zip(("shaft", "tip"), places)})
    tared = palpate.estimate(rest, catheter, reference=(0.0, 1.0)).catheter
    again, by_file = pickle.loads(pickle.dumps(tared)), palpate.Catheter.from_text(tared.to_toml())
    ours, theirs, lost = (palpate.ForceObserver(one).update(0.0, places).covariance_tip_N2 for one in (again, tared, by_file))
    np.testing.assert_allclose(ours, theirs, rtol=1e-6, atol=1e-12)
    assert np.abs(lost - theirs).max() > 0.01 * np.abs(theirs).max()
    ahead = palpate.Catheter(length_m=0.07, bending_stiffness_Nm2=(2e-4, 2e-4), torsional_stiffness_Nm2=1e-4,
                             sensors=[palpate.Sensor("tip", arc_length_m=0.07)], observer_options={"forecast_s": 0.25})
    assert copy.deepcopy(ahead).observer_options["forecast_s"] == 0.25


def test_shape(paper):
    shape = palpate.solve(paper, [0.0, 0.05, 0.0])
    again = pickle.loads(pickle.dumps(shape))
    for name, value in vars(shape).items():
        same(value, getattr(again, name))
    same(pickle.loads(pickle.dumps(palpate.solve(paper, [1e300, 0.0, 0.0]).T_base_tip, 0)),
         palpate.solve(paper, [1e300, 0.0, 0.0]).T_base_tip)


def test_estimates(heartbeat):
    estimates = palpate.estimate(heartbeat.recording, heartbeat.catheter)
    for again in (pickle.loads(pickle.dumps(estimates)), copy.deepcopy(estimates)):
        assert again.rows.tobytes() == estimates.rows.tobytes() and again.tare == estimates.tare
        np.testing.assert_allclose(again.catheter.T_tracker_base.R, estimates.catheter.T_tracker_base.R, atol=1e-15)


def test_processes(paper):
    forces = [(0.0, 0.01 * i, 0.0) for i in range(4)]
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        shapes = list(pool.map(palpate.solve, [paper] * 4, forces))
    for force, shape in zip(forces, shapes):
        np.testing.assert_allclose(shape.position_base_m, palpate.solve(paper, force).position_base_m, rtol=0, atol=1e-14)


def others(paper):
    recording = palpate.Recording([0.0], {name: (np.full((1, 3), 0.01), None) for name in ("tip", "shaft")})
    observer = palpate.ForceObserver(paper)
    estimate = observer.update(0.0, np.full((2, 3), 0.01))
    fit = palpate.identify_stiffness(palpate.Catheter.from_toml(ROOT / "examples/stiffness/catheter.toml"),
                                     ROOT / "examples/stiffness/cases.toml")
    return {"Recording": recording._data, "Frame": recording[0], "Estimate": estimate,
            "Observability": estimate.observability, "Observer": observer._observer, "StiffnessFound": fit._found,
            "ForceObserver": observer}


def test_what_stays_here(paper):
    """An observer's state, a recording, a fit: no class of ours is left to object's own ways."""
    for name, value in others(paper).items():
        for way, label in zip(WAYS, NAMES):
            with pytest.raises(TypeError) as caught:
                way(value)
            assert f"palpate.{name}: cannot be pickled or copied" in str(caught.value), (name, label)
    kinds = {name for name, kind in vars(_palpate).items() if isinstance(kind, type) and not issubclass(kind, Exception)}
    assert kinds == {*others(paper), "Catheter", "Pose", "Sensor", "Section", "RegistrationFound"} - {"ForceObserver"}


def test_spoiled_states():
    """By hand, with parts of another kind or number: refused, never a crash."""
    for kind in ("Pose", "Sensor", "Section", "Catheter"):
        for state in ("()", "(1,)", "(1, 2)", "('x', {}, None, [])", "('tip', 7) + 10 * (None,)"):
            code = f"import palpate; palpate.{kind}.__new__(palpate.{kind}).__setstate__({state})"
            ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
            assert ran.returncode == 1 and "Error" in ran.stderr.splitlines()[-1], (kind, state, ran.stderr)
