#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints a scenario in which a handle is turned up and back in steps, two seconds of rest at each, the tip free."""

POSITIONS_RAD = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 0.8, 0.6, 0.4, 0.2, 0.0)
REST_S, TURN_S = 2.0, 1.0

points = [[i * (REST_S + TURN_S) + rest, position] for i, position in enumerate(POSITIONS_RAD) for rest in (0.0, REST_S)]
print(f"""schema = 1
[scenario]
catheter = "examples/scenarios/catheters/ablation_steered.toml"
duration_s = {points[-1][0]}
[handle]
knob_rad = {{ points = {points}, course = "smooth" }}""")
