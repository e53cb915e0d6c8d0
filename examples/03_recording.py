# SPDX-License-Identifier: Apache-2.0
"""A recording read, its force estimated and held against a force sensor: the twin of 03_recording.cpp.

    python3 03_recording.py CATHETER.toml RUN.tracker.csv RUN.force.csv"""

import sys
import palpate

if len(sys.argv) != 4:
    sys.exit(__doc__)
catheter_file, recording, truth = sys.argv[1:]
try:
    estimates = palpate.estimate(recording, palpate.Catheter.from_toml(catheter_file))
    for time_s, force_N, status in list(zip(estimates.time_s, estimates.force_tip_N, estimates.status))[::200]:
        print("{:6.2f} s  {:+7.1f} {:+7.1f} {:+7.1f} mN  {}".format(time_s, *(1e3 * force_N), status))
    judged = palpate.evaluate(estimates, truth)
    print("{} frames, error {:.2f}, {:.2f}, {:.2f} mN rms; {:.0f} % within the stated 95 %".format(
        judged.frames, *(1e3 * judged.rmse_N), 100.0 * judged.inside_95.mean()))
except palpate.InputError as error:  # bad input: one line that names file, line, field and value
    sys.exit(str(error))
