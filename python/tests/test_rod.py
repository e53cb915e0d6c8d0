# SPDX-License-Identifier: Apache-2.0
"""One rod and many, against closed forms, another solver and each other."""

import json
import threading
import time

import numpy as np
import pytest
from conftest import shared

import palpate

EI, GJ, LENGTH = (0.2612e-3, 0.16664e-3), 0.1645e-3, 0.07


def shaft(precurvature_per_m=(24.57, 0.0, 0.0), **more):
    return palpate.Catheter(length_m=LENGTH, bending_stiffness_Nm2=EI, torsional_stiffness_Nm2=GJ,
                            precurvature_per_m=precurvature_per_m, sensors=[palpate.Sensor("tip", arc_length_m=LENGTH)],
                            **more)


def forces(n, size_N=0.1):
    return size_N * np.random.default_rng(7).uniform(-1.0, 1.0, (n, 3))


def test_unloaded_shaft_is_an_arc():
    """k1 > 0 turns the tangent from d3 towards -d2: r = (0, cos ks - 1, sin ks) / k."""
    s, k = np.linspace(0.0, LENGTH, 8), 24.57
    shape = palpate.solve(shaft(), arc_lengths_m=s)
    arc = np.column_stack([0.0 * s, np.cos(k * s) - 1.0, np.sin(k * s)]) / k
    np.testing.assert_allclose(shape.position_base_m, arc, atol=1e-10)
    np.testing.assert_allclose(shape.curvature_per_m, np.tile([k, 0.0, 0.0], (8, 1)), atol=1e-9)
    np.testing.assert_array_equal(shape.arc_length_m, s)


def test_small_force_bends_a_cantilever():
    """A straight shaft under F along d2 at its end: F L^3 / (3 EI1)."""
    shape = palpate.solve(shaft((0.0, 0.0, 0.0)), [0.0, 1e-5, 0.0])
    np.testing.assert_allclose(shape.T_base_tip.p[1], 1e-5 * LENGTH**3 / (3.0 * EI[0]), rtol=1e-5)
    np.testing.assert_allclose(shape.moment_local_Nm[0], [-1e-5 * LENGTH, 0.0, 0.0], rtol=1e-6, atol=1e-12)


def test_reference_rods():
    for case in json.loads(shared("reference/rod_statics.json").read_text())["cases"]:
        catheter = palpate.Catheter(
            length_m=case["length_m"],
            bending_stiffness_Nm2=(case["bending_stiffness_1_Nm2"], case["bending_stiffness_2_Nm2"]),
            torsional_stiffness_Nm2=case["torsional_stiffness_Nm2"], precurvature_per_m=case["precurvature_1_per_m"],
            sensors=[palpate.Sensor("tip", arc_length_m=case["length_m"])])
        places = [min(point["s_m"], case["length_m"]) for point in case["shape"]]
        shape = palpate.solve(catheter, case["tip_force_tip_frame_N"], moment_tip_Nm=case["tip_moment_tip_frame_Nm"],
                              arc_lengths_m=places)
        expected = [point["position_m"] for point in case["shape"]]
        np.testing.assert_allclose(shape.position_base_m, expected, atol=1e-8 * case["length_m"])


def test_sensitivities_are_derivatives():
    catheter, force, step = shaft(), np.array([0.03, -0.02, -0.05]), 1e-4
    shape = palpate.solve(catheter, force, sensitivities=True)
    for j, change in enumerate(step * np.eye(3)):
        ahead, behind = palpate.solve(catheter, force + change), palpate.solve(catheter, force - change)
        slope = (ahead.position_base_m - behind.position_base_m) / (2.0 * step)
        np.testing.assert_allclose(shape.d_position_m[:, :, j], slope, atol=2e-7)
        slope = (ahead.curvature_per_m - behind.curvature_per_m) / (2.0 * step)
        np.testing.assert_allclose(shape.d_curvature_per_m[:, :, j], slope, atol=2e-4)


def test_own_weight_sags():
    """w L^4 / (8 EI) of a clamped beam under its own weight."""
    heavy = shaft((0.0, 0.0, 0.0), distributed_load_base_N_per_m=(0.0, -1e-3, 0.0))
    sag = palpate.solve(heavy).T_base_tip.p[1]
    np.testing.assert_allclose(sag, -1e-3 * LENGTH**4 / (8.0 * EI[0]), rtol=1e-3)
    with pytest.raises(palpate.InputError, match="weight"):
        palpate.solve_batch(heavy, forces(3))


def test_batch_is_one_by_one():
    catheter, loads, places = shaft(), forces(40), [0.02, 0.0653]
    couples = 1e-3 * forces(40)
    batch = palpate.solve_batch(catheter, loads, tendon_couples_Nm=couples, arc_lengths_m=places, sensitivities=True)
    for i, (load, couple) in enumerate(zip(loads, couples)):
        one = palpate.solve(catheter, load, tendon_couple_Nm=couple, arc_lengths_m=places, sensitivities=True,
                            accuracy="realtime")
        np.testing.assert_allclose(batch.tip.position_base_m[i], one.T_base_tip.p, atol=1e-12 * LENGTH)
        np.testing.assert_allclose(batch.tip.R_base_local[i], one.T_base_tip.R, atol=1e-12)
        for station, points in enumerate(batch.stations):
            np.testing.assert_allclose(points.position_base_m[i], one.position_base_m[station], atol=1e-12 * LENGTH)
            np.testing.assert_allclose(points.R_base_local[i], one.R_base_local[station], atol=1e-12)
            np.testing.assert_allclose(points.d_position_m[i], one.d_position_m[station], atol=1e-11)
            np.testing.assert_allclose(points.d_rotation[i], one.d_rotation[station], atol=1e-9)


@pytest.mark.parametrize("spoiled", [
    lambda x: np.asfortranarray(x), lambda x: np.repeat(x, 2, axis=0)[::2], lambda x: x.astype(">f8"),
    lambda x: x[::-1].copy()[::-1], lambda x: x.tolist(),
    lambda x: np.ndarray(x.shape, np.float64, b"\0" + x.tobytes(), offset=1)],
    ids=["fortran", "strided", "other byte order", "reversed", "lists", "unaligned and read-only"])
def test_however_numbers_lie(spoiled):
    loads = forces(10)
    expected = palpate.solve_batch(shaft(), loads).tip.position_base_m
    np.testing.assert_array_equal(palpate.solve_batch(shaft(), spoiled(loads)).tip.position_base_m, expected)


def test_input_is_left_alone():
    loads = forces(10)
    loads.flags.writeable = False
    before = loads.copy()
    palpate.solve_batch(shaft(), loads)
    palpate.solve(shaft(), loads[0])
    np.testing.assert_array_equal(loads, before)


def test_views_outlive_their_batch():
    points = palpate.solve_batch(shaft(), forces(1000)).tip.position_base_m
    copy = points.copy()
    for _ in range(20):
        palpate.solve_batch(shaft(), forces(1000, 0.05))
    np.testing.assert_array_equal(points, copy)


def test_no_rods():
    assert palpate.solve_batch(shaft(), np.zeros((0, 3))).tip.position_base_m.shape == (0, 3)


def test_other_threads_run_meanwhile():
    """Without the lock released this thread would count nothing between the start and the end of the batch."""
    loads, ended = forces(400_000), threading.Event()
    inside = threading.Event()

    def work():
        inside.set()
        palpate.solve_batch(shaft(), loads, sensitivities=True, workers=1)
        ended.set()

    worker = threading.Thread(target=work)
    worker.start()
    inside.wait()
    turns = 0
    while not ended.is_set():
        turns += 1
        time.sleep(0.002)
    worker.join()
    assert turns > 5


@pytest.mark.parametrize("sensitivities", [False, True])
def test_what_is_no_shape_has_not_converged(sensitivities):
    """A load beyond all sense: False for its rod alone, at the tip and at every station."""
    loads = np.vstack([forces(5), [[1e300, 0.0, 0.0]], forces(3)])
    batch = palpate.solve_batch(shaft(), loads, arc_lengths_m=[0.0, 0.03], sensitivities=sensitivities)
    expected = [True] * 5 + [False] + [True] * 3
    for converged in (batch.converged, batch.tip.converged, *(station.converged for station in batch.stations)):
        assert converged.dtype == np.bool_ and converged.tolist() == expected
    assert not np.isfinite(batch.tip.position_base_m[5]).all()
    for force, good in zip(loads, expected):
        shape = palpate.solve(shaft(), force, sensitivities=sensitivities)
        assert shape.converged is good
        assert np.isfinite(shape.position_base_m).all() == good
    assert palpate.solve_batch(shaft(), np.zeros((0, 3))).converged.shape == (0,)


@pytest.mark.parametrize("log_stiffness", [800.0, -800.0, -20.0, 20.0])
def test_what_has_converged_is_finite(log_stiffness):
    """Also where the stiffness itself is more than a number can be: the moments come from the forces."""
    load, stiffness = [0.0, 0.1, 0.0], [log_stiffness] * 3
    shape = palpate.solve(shaft(), load, log_stiffness=stiffness)
    batch = palpate.solve_batch(shaft(), [load], log_stiffness=[stiffness], sensitivities=True)
    assert shape.converged == batch.converged[0] == (log_stiffness > 0.0)
    if shape.converged:
        for numbers in (shape.position_base_m, shape.curvature_per_m, shape.moment_local_Nm, batch.tip.d_position_m,
                        batch.tip.curvature_per_m):
            assert np.isfinite(numbers).all()


def test_what_is_beyond_the_integrators_reach_has_not_converged():
    """In one piece 10 kN is off by 4 % of the length, finite as it is; in pieces of a millimetre it is right."""
    load, whole, fine = [0.0, 6e3, -8e3], [0.0, 0.07], np.linspace(0.0, 0.07, 71)
    assert not palpate.solve(shaft(), load, arc_lengths_m=whole).converged
    assert palpate.solve(shaft(), load, arc_lengths_m=fine).converged
    assert palpate.solve_batch(shaft(), [load, [0.0, 0.1, 0.2]], arc_lengths_m=whole).converged.tolist() == [False, True]
