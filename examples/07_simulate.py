# SPDX-License-Identifier: Apache-2.0
"""A virtual experiment, seen by the observer through the tracker's poses alone: the twin of 07_simulate.cpp.

    python3 07_simulate.py SCENARIO.toml"""

import sys
import palpate

if len(sys.argv) != 2:
    sys.exit(__doc__)
try:
    run = palpate.simulate(sys.argv[1], duration_s=10.0)
except palpate.InputError as error:
    sys.exit(str(error))
for time_s, what in run.events:
    if time_s < 4.0:
        print(f"{time_s:6.2f} s  {what}")
estimates = palpate.estimate(run.recording, run.catheter)
judged = palpate.evaluate(estimates, run.truth)
print("{} frames, error {:.2f}, {:.2f}, {:.2f} mN rms, mean NEES {:.2f} (3 where the covariance is true)".format(
    judged.frames, *(1e3 * judged.rmse_N), judged.mean_nees))
