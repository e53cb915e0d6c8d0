# SPDX-License-Identifier: Apache-2.0
"""The report's force plot, made in Python: from a recording to force over time with its 95 % band.

Cells (`# %%`) for an editor or Jupyter that knows them; or as a program:

    python3 python/examples/force_plot.py [CATHETER.toml RECORDING [FORCE.csv]]

Without arguments the recording is a virtual one, of the scenario examples/scenarios/beating_heart.toml. The curves are
those of `palpate report` of the same files, number by number (python/tests/test_plot.py).
"""

# %% A recording, its catheter, and the true force where there is one
import sys
from pathlib import Path

import numpy as np

import palpate

arguments = [] if "ipykernel" in sys.modules else sys.argv[1:]
if len(arguments) >= 2:
    catheter = palpate.Catheter.from_toml(arguments[0])
    recording = palpate.read_recording(arguments[1], catheter)
    truth = palpate.read_forces(arguments[2]) if len(arguments) > 2 else None
else:
    root = Path(__file__).resolve().parents[2] if "__file__" in globals() else Path.cwd()
    run = palpate.simulate(root / "examples/scenarios/beating_heart.toml", duration_s=10.0)
    catheter, recording, truth = run.catheter, run.recording, run.truth
print(recording)

# %% The force of every frame
estimates = palpate.estimate(recording, catheter)
sizes = palpate.force_sizes(estimates)
largest = np.nanargmax(np.where(sizes.measured, sizes.size_N, np.nan))
print(f"{len(estimates)} frames, {100.0 * sizes.measured.mean():.1f} % measured")
print(f"largest force {sizes.size_N[largest]:.4f} +- {sizes.sigma_N[largest]:.4f} N at {sizes.time_s[largest]:.3f} s")

# %% Against the truth: error along d1, d2, d3, and whether the sigmas are true
if truth is not None:
    found = palpate.evaluate(estimates, truth)
    print("RMSE [mN]:", np.round(1e3 * found.rmse_N, 2), "inside 95 %:", np.round(found.inside_95, 3))

# %% The picture: size of the force on top, its components below; gaps where nothing was measured
from matplotlib import pyplot  # noqa: E402

figure, (above, below) = pyplot.subplots(2, 1, figsize=(9.0, 6.5), sharex=True, layout="constrained")
palpate.plot.plot_force(estimates, truth, unit="g", ax=above)
palpate.plot.plot_force(estimates, truth, unit="g", components=("x", "y", "z"), ax=below)
above.set_xlabel("")
figure.savefig("force.png", dpi=110)

# %% The shape at the largest force
shape = palpate.solve(catheter, estimates.force_tip_N[largest])
palpate.plot.plot_shape(shape).figure.savefig("shape.png", dpi=110)
print("written: force.png, shape.png")
