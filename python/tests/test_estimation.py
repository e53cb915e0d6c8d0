# SPDX-License-Identifier: Apache-2.0
"""Offline estimation and what judges it, against numpy and the command line."""

import json
import warnings

import numpy as np
import pytest
from conftest import ROOT, palpate_program

import palpate


@pytest.fixture
def run():
    return palpate.simulate(ROOT / "examples/scenarios/beating_heart.toml", duration_s=6.0)


@pytest.fixture
def estimates(run):
    return palpate.estimate(run.recording, run.catheter)


def test_evaluation_by_hand(run, estimates):
    found = palpate.evaluate(estimates, run.truth)
    late = estimates.time_s >= estimates.time_s[0] + 1.0
    true = np.column_stack([np.interp(estimates.time_s, run.truth["time_s"], f) for f in run.truth["force_tip_N"].T])
    error = (estimates.force_tip_N - true)[late]
    sigma = estimates.sigma_tip_N[late]
    np.testing.assert_allclose(found.rmse_N, np.sqrt((error**2).mean(axis=0)), rtol=1e-9)
    np.testing.assert_allclose(found.mean_N, error.mean(axis=0), rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(found.largest_N, np.abs(error).max(axis=0), rtol=1e-12)
    np.testing.assert_allclose(found.inside_3_sigma, (np.abs(error) <= 3.0 * sigma).mean(axis=0))
    nees = [e @ np.linalg.solve(P, e) for e, P in zip(error, estimates.covariance_tip_N2[late])]
    assert found.mean_nees == pytest.approx(np.mean(nees), rel=1e-9)
    assert found.frames == late.sum()


def test_force_sizes_by_hand(estimates):
    sizes = palpate.force_sizes(estimates)
    np.testing.assert_allclose(sizes.size_N, np.linalg.norm(estimates.force_tip_N, axis=1), rtol=1e-12)
    assert np.all(sizes.sigma_N > 0.0) and np.array_equal(sizes.measured, np.isin(estimates.status, ["UPDATED", "RESEEDED"]))


def test_base_force_is_the_tip_force_turned(estimates):
    turned = np.einsum("nij,nj->ni", estimates["R_base_tip"], estimates.force_tip_N)
    np.testing.assert_allclose(turned, estimates["force_base_N"], atol=1e-12)


def test_budget_adds_up(heartbeat):
    estimates = palpate.estimate(heartbeat.recording, heartbeat.catheter)
    total = (estimates["sigma_by_source_N"] ** 2).sum(axis=1)
    np.testing.assert_allclose(total, estimates.sigma_tip_N**2, rtol=1e-6)
    assert palpate.estimation.SOURCES[0] == "noise" and estimates["sigma_by_source_N"].shape[1:] == (7, 3)


def test_smoothing_narrows(run, estimates):
    smooth = palpate.estimate(run.recording, run.catheter, smooth=True)
    assert np.all(smooth.sigma_tip_N[10:-10].mean(axis=0) < estimates.sigma_tip_N[10:-10].mean(axis=0))
    with pytest.raises(palpate.InputError, match="forecast_s"):
        palpate.estimate(run.recording, run.catheter, smooth=True, forecast_s=0.1)


def test_reference_corrects(heartbeat, tmp_path):
    """In both the command line's way and ours; the interval is not free of force, so that there is something to warn of."""
    out = tmp_path / "e.csv"
    ran = palpate_program("estimate", "--catheter", heartbeat.toml, heartbeat.recording, "--reference", "0:2", "--out", out)
    assert ran.returncode == 0, ran.stderr
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ours = palpate.estimate(heartbeat.recording, heartbeat.catheter, reference=(0.0, 2.0))
    said = [line.removeprefix("palpate: warning: ") for line in ran.stderr.splitlines()]
    assert [str(w.message) for w in caught] == said == list(ours.warnings)
    np.testing.assert_allclose(palpate.read_estimate(out).force_tip_N, ours.force_tip_N, rtol=5.1e-9)
    assert ours.tare.frames > 0 and np.any(ours.tare.base_shift_m != 0.0)
    assert np.any(ours.catheter.T_tracker_base.p != heartbeat.catheter.T_tracker_base.p)
    corrected = palpate.Catheter.from_text(heartbeat.toml.read_text() + "\n[reference]\nfrom_s = 0.0\nto_s = 2.0\n")
    once = palpate.estimate(heartbeat.recording, corrected)
    again = palpate.estimate(heartbeat.recording, once.catheter)  # what is corrected is not corrected a second time
    assert again.tare is None
    np.testing.assert_array_equal(again.force_tip_N, once.force_tip_N)
    with pytest.raises(palpate.InputError, match="reference"):
        palpate.estimate(heartbeat.recording, heartbeat.catheter, reference=(2.0, 0.0))
    with pytest.raises(palpate.InputError, match="expected an interval with frames"):
        palpate.estimate(heartbeat.recording, heartbeat.catheter, reference=(1000.0, 1001.0))


def test_strict(tmp_path):
    from conftest import Case

    faults = Case("faults", tmp_path)
    ran = palpate_program("estimate", "--catheter", faults.toml, faults.recording, "--strict", "--out", tmp_path / "e.csv")
    with pytest.raises(palpate.InputError) as caught:
        palpate.estimate(faults.recording, faults.catheter, strict=True)
    assert ran.returncode == 2 and ran.stderr.strip() == f"palpate: {caught.value}"


def test_forecast(run):
    estimates = palpate.estimate(run.recording, run.catheter, forecast_s=0.025)
    observer = palpate.ForceObserver(run.catheter)
    for frame in run.recording:
        observer.update_frame(frame)
    mean, covariance = observer.forecast(0.025)
    np.testing.assert_allclose(estimates["forecast_tip_N"][-1], mean, rtol=1e-12)
    np.testing.assert_allclose(estimates["forecast_covariance_N2"][-1], covariance, rtol=1e-12)


def test_observer_tells_what_it_left_out(paper):
    observer = palpate.ForceObserver(paper)
    shape = palpate.solve(paper, [0.01, 0.02, -0.03], arc_lengths_m=[s.arc_length_m for s in paper.sensors])
    one_turn = [1.0, 0.0, 0.0, 0.0]
    quaternion = [quaternion_of(R) for R in shape.R_base_local]
    good = observer.update(0.0, shape.position_base_m, quaternion)
    assert good.status == "UPDATED" and good.rejections == ["none", "none"] and good.sensors_used == 2
    np.testing.assert_allclose(good.force_tip_N, [0.01, 0.02, -0.03], atol=5e-3)
    assert not good.force_tip_N.flags.writeable and np.linalg.eigvalsh(good.covariance_tip_N2).min() > 0.0
    unseen = observer.update(0.1, np.full((2, 3), np.nan), [one_turn, one_turn])
    assert unseen.status == "HELD" and unseen.rejections == ["missing", "missing"]
    broken = observer.update(0.2, [[np.nan, 0.0, 0.05], shape.position_base_m[1]], [quaternion[0], [2.0, 0.0, 0.0, 0.0]])
    assert broken.status == "HELD" and broken.sensors_used == 0 and broken.rejections[0] == "not finite"
    back = observer.update(0.1, shape.position_base_m, quaternion)
    assert back.status == "REJECTED"
    assert observer.update(float("nan"), shape.position_base_m, quaternion).status == "REJECTED"
    assert str(good.observability) == "all observable" or "not observable" in str(good.observability)


def test_views_outlive_their_estimate(paper):
    observer = palpate.ForceObserver(paper)
    force = observer.update(0.0, np.full((2, 3), np.nan)).force_tip_N
    for i in range(100):
        observer.update(0.1 * i + 0.1, np.full((2, 3), np.nan))
    np.testing.assert_array_equal(force, np.zeros(3))


def quaternion_of(R):
    w = 0.5 * np.sqrt(max(1.0 + np.trace(R), 1e-12))
    return [w, (R[2, 1] - R[1, 2]) / (4 * w), (R[0, 2] - R[2, 0]) / (4 * w), (R[1, 0] - R[0, 1]) / (4 * w)]


def test_simulation_is_the_command_lines(tmp_path):
    scenario = ROOT / "examples/scenarios/beating_heart.toml"
    ran = palpate_program("simulate", scenario, "--duration", "3", "--seed", "5", "--out", tmp_path / "run", "--json")
    assert ran.returncode == 0, ran.stderr
    json.loads(ran.stdout)
    ours = palpate.simulate(scenario, duration_s=3.0, seed=5)
    theirs = palpate.read_recording(tmp_path / "run.tracker.csv")
    np.testing.assert_allclose(ours.recording["tip"]["position_m"], theirs["tip"]["position_m"], rtol=0,
                               atol=0.51e-6)
    np.testing.assert_allclose(ours.truth["force_tip_N"], palpate.read_forces(tmp_path / "run.force.csv")["force_tip_N"],
                               rtol=1e-8, atol=1e-12)
    assert (tmp_path / "run.catheter.toml").read_text() == ours.catheter_toml
    other = palpate.simulate(scenario, duration_s=3.0, seed=6)
    assert np.any(other.recording["tip"]["position_m"] != ours.recording["tip"]["position_m"])
    clean = palpate.simulate(scenario, duration_s=0.5, noise_free=True, rate_hz=20.0)
    assert len(clean.recording) == 10
    np.testing.assert_allclose(np.linalg.norm(clean.truth["p_base_tip_m"], axis=1) < 0.07, True)


def test_simulated_tendon_is_used(tmp_path):
    """The frames bring the tendon's moment along: nothing is warned of, and the force is that of the files."""
    scenario = ROOT / "examples/scenarios/stiffness_drift.toml"
    with warnings.catch_warnings():
        warnings.simplefilter("error", palpate.PalpateWarning)
        run = palpate.simulate(scenario, duration_s=2.0)
        estimates = palpate.estimate(run.recording, run.catheter)
    palpate_program("simulate", scenario, "--duration", "2", "--out", tmp_path / "run")
    theirs = palpate.estimate(tmp_path / "run.tracker.csv", run.catheter, tendon=tmp_path / "run.tendon.csv")
    np.testing.assert_allclose(estimates.force_tip_N, theirs.force_tip_N, atol=2e-3)
