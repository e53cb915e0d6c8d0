# SPDX-License-Identifier: Apache-2.0
"""Where things are, and catheters for the recordings that another program made."""

import json
import os
import subprocess
from pathlib import Path

import pytest

import palpate

ROOT = Path(__file__).resolve().parents[2]
SHARED = Path(os.environ.get("PALPATE_SHARED_DIR", ROOT.parent / "shared"))
RECORDINGS = ["weight_planar", "heartbeat", "faults", "stiffness_drift", "wrong_precurvature", "biased_tracker", "jumps"]

TOML = """schema = 1
[catheter]
length_mm = {length_mm!r}
bending_stiffness_Nm2 = [{EI1!r}, {EI2!r}]
torsional_stiffness_Nm2 = {GJ!r}
stiffness_sigma_percent = 5.0
precurvature_per_m = [{k1!r}, 0.0, 0.0]
precurvature_sigma_per_m = [0.5, 0.5, 0.2]
{tendon}
[base]
quaternion_wxyz = {quaternion}
position_mm = {position}
position_sigma_mm = 0.3
rotation_sigma_deg = 0.3
[[sensor]]
name = "tip"
arc_length_mm = 70.0
{noise}
[[sensor]]
name = "shaft"
arc_length_mm = 65.3
{noise}
"""


def shared(relative: str) -> Path:
    """Reference data live outside the project; a test that needs them skips without."""
    path = SHARED / relative
    if not path.exists():
        pytest.skip(f"shared data absent: {path}")
    return path


def catheter_toml(name: str) -> str:
    """What an operator's catheter file would say of one of the shared recordings."""
    told = json.loads(shared("recordings/recordings.json").read_text())[name]
    noise = (f"kind = \"pose\"\nnoise_mm = {told['noise_sd_mm_per_axis']!r}\nnoise_deg = {told['noise_sd_deg_per_axis']!r}\n"
             f"bias_mm = {told.get('accuracy_rms_mm', 0.0)!r}\nbias_deg = {told.get('accuracy_rms_deg', 0.0)!r}")
    driven = told["precurvature_1_per_m"] is None
    return TOML.format(
        length_mm=1e3 * told["length_m"],
        EI1=told["bending_stiffness_1_Nm2"],
        EI2=told["bending_stiffness_2_Nm2"],
        GJ=told["torsional_stiffness_Nm2"],
        k1=0.0 if driven else float(told.get("believed_precurvature_1_per_m", told["precurvature_1_per_m"])),
        tendon='[tendon]\nmodel = "couple"\nmoment_sigma_percent = 2.0\n' if driven else "",
        quaternion=told["base_in_tracker"]["quaternion_wxyz"],
        position=told["base_in_tracker"]["position_mm"],
        noise=noise,
    )


class Case:
    """One shared recording with its catheter file."""

    def __init__(self, name: str, folder: Path) -> None:
        self.name = name
        self.recording = shared(f"recordings/{name}.tracker.csv")
        self.truth = shared(f"recordings/{name}.force.csv")
        self.toml = folder / f"{name}.catheter.toml"
        self.toml.write_text(catheter_toml(name))
        tendon = SHARED / f"recordings/{name}.tendon.csv"
        self.tendon = tendon if tendon.exists() else None

    @property
    def catheter(self) -> palpate.Catheter:
        return palpate.Catheter.from_toml(self.toml)


@pytest.fixture
def heartbeat(tmp_path: Path) -> Case:
    return Case("heartbeat", tmp_path)


@pytest.fixture
def paper() -> palpate.Catheter:
    return palpate.Catheter.from_toml(ROOT / "examples/paper_catheter.toml")


def program(variable: str) -> str:
    """A program that the build names in the environment."""
    path = os.environ.get(variable, "")
    if not Path(path).is_file():
        pytest.skip(f"{variable}: no such program: '{path}'")
    return path


def palpate_program(*arguments: object) -> "subprocess.CompletedProcess[str]":
    command = [program("PALPATE_BINARY"), *map(str, arguments)]
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}  # a sanitizer's is Python's alone
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
