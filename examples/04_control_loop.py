# SPDX-License-Identifier: Apache-2.0
"""A loop over a tracker that falls silent for 200 ms: the twin of 04_control_loop.cpp, by the recording's own clock.

    python3 04_control_loop.py CATHETER.toml RUN.tracker.csv

What must keep a millisecond belongs into C++ (docs/howto/cpp_loop.md); the rules are the same here."""

import sys
import numpy as np
import palpate

if len(sys.argv) != 3:
    sys.exit(__doc__)
catheter = palpate.Catheter.from_toml(sys.argv[1])
frames = [frame for frame in palpate.read_recording(sys.argv[2], catheter) if not 0.4 < frame.time_s < 0.6]
observer = palpate.ForceObserver(catheter)
STALE_S = 0.1  # four frames: after that the force is a guess
measured_s, held, largest_N = -np.inf, 0, 0.0
for cycle in range(1000):
    now_s = 1e-3 * cycle
    while frames and frames[0].time_s <= now_s:
        frame = frames.pop(0)
        if observer.update_frame(frame).status in ("UPDATED", "RESEEDED"):
            measured_s = frame.time_s
    if now_s - measured_s > STALE_S:
        held += 1  # silence is not "no force"
    else:
        force_N, covariance_N2 = observer.forecast(now_s - measured_s)
        largest_N = max(largest_N, float(np.linalg.norm(force_N)))
print(f"1000 cycles, {held} of them held while the tracker was silent; largest force {101.97162 * largest_N:.1f} g")
sys.exit(0 if 50 < held < 400 else 1)
