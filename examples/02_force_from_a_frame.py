# SPDX-License-Identifier: Apache-2.0
"""One frame of two tracker poses in, one force out, with all that makes it uncertain: the twin of 02_force_from_a_frame.cpp."""

import numpy as np
import palpate

catheter = palpate.Catheter(
    length_m=0.070, bending_stiffness_Nm2=(0.2612e-3, 0.16664e-3), torsional_stiffness_Nm2=0.1645e-3, precurvature_per_m=(24.57, 0.0, 0.0),
    sensors=[palpate.Sensor("tip", arc_length_m=0.070), palpate.Sensor("shaft", arc_length_m=0.0653)],
    stiffness_sigma_fraction=0.03, precurvature_sigma_per_m=(0.3, 0.3, 0.2))
truth_N = np.array((0.02, -0.01, -0.10))  # tip axes; pressing is -z

# What a tracker without noise would say: the clamp stands at its origin.
shape = palpate.solve(catheter, truth_N, arc_lengths_m=[0.070, 0.0653])


def quaternion_wxyz(R):
    """Of a rotation by less than half a turn."""
    w = 0.5 * np.sqrt(1.0 + np.trace(R))
    return np.array((w, *(np.array((R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1])) / (4.0 * w))))


observer = palpate.ForceObserver(catheter)
estimate = observer.update(0.0, shape.position_base_m, [quaternion_wxyz(R) for R in shape.R_base_local])
sigma_N = np.sqrt(np.diag(estimate.covariance_tip_N2))
print(f"{estimate.status}, {estimate.sensors_used} of {len(catheter.sensors)} sensors used")
for axis, force, sigma, true in zip("xyz", estimate.force_tip_N, sigma_N, truth_N):
    print(f"F{axis} = {1e3 * force:+6.1f} mN +- {1e3 * sigma:4.1f}   (true: {1e3 * true:+6.1f})")
assert np.all(np.abs(estimate.force_tip_N - truth_N) < 4.0 * sigma_N)
