# SPDX-License-Identifier: Apache-2.0
"""Python ends while a daemon thread is inside a call that others run beside."""

import subprocess
import sys

import pytest
from conftest import ROOT, palpate_program

SCENARIO = ROOT / "examples/scenarios/beating_heart.toml"
SCRIPT = """
import sys, threading, time
import numpy as np
import palpate
scenario, session, call = sys.argv[1:]
run = palpate.simulate(scenario, duration_s=4.0)
forces = np.zeros((20000, 3))
calls = {
    "estimate": lambda: palpate.estimate(run.recording, run.catheter),
    "solve_batch": lambda: palpate.solve_batch(run.catheter, forces),
    "simulate": lambda: palpate.simulate(scenario, duration_s=4.0),
    "read_estimate": lambda: palpate.read_estimate(session),
}
begun = threading.Event()
def work():
    begun.set()
    while True:
        calls[call]()
threading.Thread(target=work, daemon=True).start()
begun.wait()
time.sleep(0.02)
"""


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shutdown")
    for command in (("simulate", SCENARIO, "--duration", 4, "--out", folder / "run"),
                    ("record", folder / "run.tracker.csv", "--catheter", folder / "run.catheter.toml", "--fast", "--out",
                     folder / "run.palpate")):
        ran = palpate_program(*command)
        assert ran.returncode == 0, ran.stderr
    return folder / "run.palpate"


@pytest.mark.parametrize("call", ["estimate", "solve_batch", "simulate", "read_estimate"])
def test_a_daemon_at_work(session, call):
    for _ in range(4):
        ran = subprocess.run([sys.executable, "-c", SCRIPT, SCENARIO, session, call], capture_output=True, text=True,
                             check=False, timeout=120)
        assert (ran.returncode, ran.stderr) == (0, "")
