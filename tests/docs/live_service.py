# SPDX-License-Identifier: Apache-2.0
"""What runs while a page's commands do: a `palpate serve` to talk to, a tracker's server to listen to, on free ports."""

import json
import subprocess
import sys
import threading
import time
import urllib.request
from contextlib import contextmanager
from pathlib import Path

USUAL_PORT, TRACKER_PORT = "127.0.0.1:18946", "127.0.0.1:18944"  # that the pages write
FREE_PORTS = (" --openigtlink-port", " --dashboard-port")  # other tests may hold the usual ones
MOST_SECONDS, ENOUGH_FRAMES = 20.0, 20  # until it measures, and knows its rate


def on_free_ports(command):
    """The command with ports that nobody holds, unless it says which."""
    for flag in FREE_PORTS:
        command += "" if flag in command else flag + " 0"
    return command


def frames_of(port, token):
    """That have come, of its first catheter."""
    request = urllib.request.Request(f"http://127.0.0.1:{port}/api/health", headers={"Authorization": f"Bearer {token}"})
    with urllib.request.urlopen(request, timeout=5.0) as answer:
        return json.load(answer)["catheters"][0]["frames"]


def first_line(process):
    """What it says at its start; a process that says nothing is ended by the caller."""
    lines = []
    reader = threading.Thread(target=lambda: lines.append(process.stdout.readline()), daemon=True)
    reader.start()
    reader.join(MOST_SECONDS)
    return lines[0].strip() if lines else ""


@contextmanager
def running(command, folder, environment):
    """A process that is ended behind the block."""
    process = subprocess.Popen(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True)
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.communicate(timeout=MOST_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


@contextmanager
def serving(command, folder, environment):
    """Runs the service; gives the environment with $TOKEN, and what stands for the usual port."""
    with running(["bash", "-c", f"exec {on_free_ports(command)} --json"], folder, environment) as process:
        line = first_line(process)
        if not line.startswith("{"):
            raise RuntimeError(f"the service did not start: {line or 'it said nothing'}")
        said, ends = json.loads(line), time.monotonic() + MOST_SECONDS
        while frames_of(said["dashboard_port"], said["token"]) < ENOUGH_FRAMES and time.monotonic() < ends:
            time.sleep(0.1)
        yield dict(environment, TOKEN=said["token"]), {USUAL_PORT: f"127.0.0.1:{said['dashboard_port']}"}


@contextmanager
def tracking(recording, folder, environment):
    """Plays the recording as a PLUS server would; gives what stands for its usual port."""
    program = Path(__file__).with_name("plus_server.py")
    with running([sys.executable, "-B", str(program), recording], folder, environment) as process:
        line = first_line(process)
        if not line.isdigit():
            raise RuntimeError(f"the tracker did not start: {line or 'it said nothing'}")
        yield environment, {TRACKER_PORT: f"127.0.0.1:{line}"}
