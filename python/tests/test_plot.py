# SPDX-License-Identifier: Apache-2.0
"""What is drawn are the report's numbers; gaps where nothing was measured."""

import json
import re
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT, Case, palpate_program

import palpate

pyplot = pytest.importorskip("matplotlib.pyplot")


def report_of(case, folder):
    out = folder / "report.html"
    ran = palpate_program("report", "--catheter", case.toml, case.recording, "--truth", case.truth, "--out", out)
    if ran.returncode and "without" in ran.stderr:
        pytest.skip(ran.stderr.strip())
    assert ran.returncode == 0, ran.stderr
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', out.read_text(), re.DOTALL)
    return json.loads(found.group(1))["curves"]


@pytest.fixture(autouse=True)
def closed():
    yield
    pyplot.close("all")


def rounded(values, digits):
    return [float(f"{value:.{digits}g}") for value in values]


@pytest.mark.parametrize("name", ["heartbeat", "faults"])
def test_curves_are_the_reports(name, tmp_path):
    case = Case(name, tmp_path)
    curves = report_of(case, tmp_path)
    estimates = palpate.estimate(case.recording, case.catheter)
    sizes = palpate.force_sizes(estimates)
    assert curves["frames"] == len(curves["time_s"]) == len(estimates)
    assert [curves["statuses"][i] for i in curves["status"]] == list(estimates.status)
    assert curves["sigma_size_N"] == rounded(sizes.sigma_N, 3)
    for i, axis in enumerate("xyz"):
        assert curves[f"f{axis}_N"] == rounded(estimates.force_tip_N[:, i], 9)
        assert curves[f"sigma_{axis}_N"] == rounded(estimates.sigma_tip_N[:, i], 3)
    # and what plot_force draws is that, in grams
    lines = palpate.plot.plot_force(estimates, case.truth, components=("size", "z")).get_lines()
    drawn = [line.get_ydata() / palpate.plot._UNITS["g"] for line in lines]
    size = np.linalg.norm([curves["fx_N"], curves["fy_N"], curves["fz_N"]], axis=0)
    measured = np.isin(estimates.status, ["UPDATED", "RESEEDED"])
    np.testing.assert_allclose(drawn[0], np.where(measured, size, np.nan), rtol=5.1e-9)
    np.testing.assert_allclose(drawn[2], np.where(measured, curves["fz_N"], np.nan), rtol=5.1e-9)
    truth = np.linalg.norm([curves["truth_x_N"], curves["truth_y_N"], curves["truth_z_N"]], axis=0)
    np.testing.assert_allclose(np.interp(curves["time_s"], lines[1].get_xdata(), drawn[1]), truth, atol=2e-4)
    assert name != "faults" or not measured.all()


def test_band_holds_95_percent(heartbeat):
    estimates = palpate.estimate(heartbeat.recording, heartbeat.catheter)
    time_s, value, low, high = palpate.plot.force_curve(estimates, "y")
    np.testing.assert_allclose((high - value) / estimates.sigma_tip_N[:, 1], 1.959964, rtol=1e-6)
    np.testing.assert_allclose(value - low, high - value, rtol=1e-9)
    assert palpate.plot.force_curve(estimates, "size")[2].min() >= 0.0


def test_axes_and_units(heartbeat):
    estimates = palpate.estimate(heartbeat.recording, heartbeat.catheter)
    axes = pyplot.subplots()[1]
    assert palpate.plot.plot_force(estimates, unit="N", components="x", ax=axes) is axes
    np.testing.assert_allclose(axes.get_lines()[0].get_ydata(), palpate.plot.force_curve(estimates, "x")[1])
    assert axes.get_ylabel() == "force on the tip [N]"
    for wrong in ({"unit": "lbf"}, {"components": ("w",)}):
        with pytest.raises(palpate.InputError, match="expected one of"):
            palpate.plot.plot_force(estimates, **wrong)
    with pytest.raises(TypeError):
        palpate.plot.plot_shape(5)


def test_shape(paper):
    shape = palpate.solve(paper, [0.03, 0.0, -0.05])
    axes = palpate.plot.plot_shape(shape)
    np.testing.assert_allclose(np.array(axes.get_lines()[0].get_data_3d()).T, 1e3 * shape.position_base_m)
    spans = [np.diff(limits)[0] for limits in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())]
    np.testing.assert_allclose(spans, spans[0])


def test_matplotlib_is_not_loaded_before_a_picture():
    code = "import sys, palpate; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_example_runs(tmp_path):
    ran = subprocess.run([sys.executable, ROOT / "python/examples/force_plot.py"], cwd=tmp_path, capture_output=True,
                         text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert "written: force.png, shape.png" in ran.stdout
    assert (tmp_path / "force.png").stat().st_size > 20_000 and (tmp_path / "shape.png").stat().st_size > 10_000


def test_example_on_a_recording(heartbeat, tmp_path):
    command = [sys.executable, ROOT / "python/examples/force_plot.py", heartbeat.toml, heartbeat.recording, heartbeat.truth]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert "1200 frames" in ran.stdout
