#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lays a recording of the shared data into this folder, with its catheter file: shared_recording.py NAME.

The catheter is that of recordings.json, known exactly, as tests/shared_recordings.hpp has it.
"""

import json
import os
import shutil
import sys
from pathlib import Path

SENSOR = """
[[sensor]]
name = "{name}"
kind = "pose"
arc_length_mm = {arc_length_mm!r}
noise_mm = {noise_sd_mm_per_axis!r}
noise_deg = {noise_sd_deg_per_axis!r}
"""


def catheter_file(told):
    """The TOML of one entry."""
    base = told["base_in_tracker"]
    length_mm = 1e3 * told["length_m"]
    sensors = (SENSOR.format(name=name, arc_length_mm=min(round(1e3 * at_m, 9), length_mm), **told)
               for name, at_m in told["sensor_arc_length_m"].items())
    return f"""schema = 1
[catheter]
length_mm = {length_mm!r}
bending_stiffness_Nm2 = [{told["bending_stiffness_1_Nm2"]!r}, {told["bending_stiffness_2_Nm2"]!r}]
torsional_stiffness_Nm2 = {told["torsional_stiffness_Nm2"]!r}
precurvature_per_m = [{told["precurvature_1_per_m"]!r}, 0.0, 0.0]

[base]
quaternion_wxyz = {base["quaternion_wxyz"]!r}
position_mm = {base["position_mm"]!r}
""" + "".join(sensors)


def main(name):
    shared = Path(os.environ["PALPATE_SHARED_DIR"], "recordings")
    told = json.loads((shared / "recordings.json").read_text(encoding="utf-8"))[name]
    Path(f"{name}.toml").write_text(catheter_file(told), encoding="utf-8")
    for file in (f"{name}.tracker.csv", f"{name}.force.csv", "bounds.json"):
        shutil.copy(shared / file, ".")


if __name__ == "__main__":
    main(sys.argv[1])
