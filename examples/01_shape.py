# SPDX-License-Identifier: Apache-2.0
"""The shape of a shaft under a force on its tip, and how far the tip yields: the twin of 01_shape.cpp."""

import numpy as np
import palpate

# 70 mm long, bent to 24.57 1/m about x (the paper's catheter). A catheter has sensors; the shape asks for none of them.
catheter = palpate.Catheter(length_m=0.070, bending_stiffness_Nm2=(0.2612e-3, 0.16664e-3), torsional_stiffness_Nm2=0.1645e-3,
                            precurvature_per_m=(24.57, 0.0, 0.0), sensors=[palpate.Sensor("tip", arc_length_m=0.070)])
# 10 g press against the tip, 2 g push it aside; axes of the tip.
shape = palpate.solve(catheter, (0.02, 0.0, -0.10), arc_lengths_m=np.linspace(0.0, 0.07, 8), sensitivities=True)

print("  s [mm]    x [mm]    y [mm]    z [mm]   bend [1/m]")
for s, p, bend in zip(shape.arc_length_m, shape.position_base_m, shape.curvature_per_m):
    print(f"{1e3 * s:8.1f}  {1e3 * p[0]:8.3f}  {1e3 * p[1]:8.3f}  {1e3 * p[2]:8.3f}  {bend[0]:8.2f}")
yield_mm_per_g = 1e3 / 101.97162 * np.linalg.norm(shape.d_position_m[-1], axis=0)
print("One more gram-force along the tip's x, y, z moves it by {:.2f}, {:.2f}, {:.2f} mm.".format(*yield_mm_per_g))
