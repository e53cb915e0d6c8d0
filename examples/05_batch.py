# SPDX-License-Identifier: Apache-2.0
"""One shaft under 100 000 tip forces at once: the twin of 05_batch.cpp."""

import time
import numpy as np
import palpate

catheter = palpate.Catheter(length_m=0.070, bending_stiffness_Nm2=(0.2612e-3, 0.16664e-3), torsional_stiffness_Nm2=0.1645e-3,
                            precurvature_per_m=(24.57, 0.0, 0.0), sensors=[palpate.Sensor("tip", arc_length_m=0.070)])
force_tip_N = np.random.default_rng(1).uniform(-0.1, 0.1, (100_000, 3))

start = time.perf_counter()
shapes = palpate.solve_batch(catheter, force_tip_N)
took_us = 1e6 * (time.perf_counter() - start)

unloaded = palpate.solve(catheter)
moved_m = np.linalg.norm(shapes.tip.position_base_m - unloaded.T_base_tip.p, axis=1)
print(f"{len(moved_m)} rods, {took_us / len(moved_m):.2f} us each")
print(f"the tip moves by {1e3 * moved_m.mean():.1f} mm in the mean, {1e3 * moved_m.max():.1f} mm at most")
