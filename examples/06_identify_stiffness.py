# SPDX-License-Identifier: Apache-2.0
"""Stiffness from hung weights, read off a load-case file: the twin of 06_identify_stiffness.cpp.

    python3 06_identify_stiffness.py CATHETER.toml CASES.toml"""

import sys
import palpate

if len(sys.argv) != 3:
    sys.exit(__doc__)
try:
    fit = palpate.identify_stiffness(palpate.Catheter.from_toml(sys.argv[1]), sys.argv[2])
except palpate.InputError as error:
    sys.exit(str(error))
for name, value, log_sigma in fit.unknowns:
    print(f"{name} = {value:.4g} N m^2 +- {100.0 * log_sigma:.1f} %")
print(f"residuals {1e3 * fit.rms_m:.2f} mm rms")
sys.exit(0 if fit.converged else 1)
