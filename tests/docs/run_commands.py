#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands and the Python of the documentation, page by page, as a reader would.

A code block whose first line begins with `palpate ` or `curl ` is run, and every block of Python, each page in an empty folder with
`examples` in it. Python blocks of a page share their names, in order. In front of a block may stand
  <!-- run -->             run it, whatever it begins with     <!-- run: COMMAND -->  set-up that a reader does not see
  <!-- norun: reason -->   do not run it                       <!-- file: NAME -->    write it to this file
  <!-- needs: shared -->   only where the shared data is there <!-- needs: PROGRAM --> only where this program is
  <!-- skip: BEGINNING: reason -->  do not run the commands of the block that begin so
  <!-- serves: COMMAND --> meanwhile this service runs: $TOKEN is its token, and its port stands for the usual one
  <!-- tracker: T.csv -->  meanwhile a PLUS server's stand-in plays this recording, at a port that stands for the usual one
  <!-- output -->          its lines stand, in order, in what the commands before it have printed; numbers within 2 %
  <!-- prints: ... -->     each of its lines begins one that was printed           <!-- exit: 1 -->  the exit code
  <!-- answer -->          its JSON is in that of the answers, key by key; numbers are those of another moment
Exit code 1 where a command fails. The share that is not run is printed, with the reasons.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from pathlib import Path

from compare import missing_line
from live_service import on_free_ports, serving, tracking
from page import COMPARED, read_page

ENDS_BY_ITSELF = " --for 1.5"  # `palpate serve` of a page would run until Ctrl-C
MOST_SECONDS, SLOW_SECONDS = 120, 5.0  # a command that does not end; one that is told
CURL_SAYS = "fail-with-body\nsilent\nshow-error\nmax-time = 20\n"  # an answer other than 200 is a failure


def runnable(command):
    """The command as it is run: a service ends by itself and takes ports that are free."""
    if not command.startswith("palpate serve"):
        return command
    return on_free_ports(command) + ("" if " --for " in command else ENDS_BY_ITSELF)


class Page:
    """A page that is run: what it did, and the first thing that went wrong."""

    def __init__(self, path, folder, environment):
        self.path, self.folder, self.environment = path, Path(folder), environment
        self.ran, self.passed_over, self.slow, self.failure = 0, [], [], ""
        self.blocks = []  # of Python, each in a file

    def run(self):
        printed = []  # None: nothing was run, so nothing is compared
        for step in read_page(self.path.read_text()):
            if step.kind in COMPARED:
                if printed is not None and (line := missing_line(step.kind, step.lines, printed)) is not None:
                    return self.fail(step, f"was not printed: {line}\n  printed:\n    " + "\n    ".join(printed))
                continue
            reason = step.norun or self.lack(step)
            if reason:
                if step.kind in ("commands", "python"):
                    self.passed_over.append((len(step.lines) if step.kind == "commands" else 1, reason))
                printed = None
                continue
            printed = []
            if not self.run_step(step, printed):
                return None
        return None

    def lack(self, step):
        """What is not here that the step needs; empty where all is."""
        if step.needs == "shared":
            return "" if Path(self.environment["PALPATE_SHARED_DIR"]).is_dir() else "the shared data is not there"
        program = step.needs or ("curl" if any(line.startswith("curl ") for line in step.lines) else "")
        if program and not shutil.which(program, path=self.environment["PATH"]):
            return f"{program} is not there"
        wants_module = step.kind == "python" and any("palpate" in line for line in step.lines if "import" in line)
        module_there = any(Path(self.environment.get("PYTHONPATH", "")).glob("palpate/_palpate*.so"))
        return "the Python module was not built" if wants_module and not module_there else ""

    def run_step(self, step, printed):
        if step.kind == "file":
            file = (self.folder / step.name).resolve()
            if not file.is_relative_to(self.folder.resolve()):
                return self.fail(step, f"{step.name} is not in the page's folder")
            file.write_text("\n".join(step.lines) + "\n")
            return True
        if step.kind == "python":
            return self.run_commands(step, [self.python_command(step)], printed, self.environment)
        try:
            with self.meanwhile(step) as (environment, ports):
                commands = step.lines
                for usual, port in ports.items():
                    commands = [command.replace(usual, port) for command in commands]
                return self.run_commands(step, commands, printed, environment)
        except (RuntimeError, OSError) as error:
            return self.fail(step, f"{step.serves or step.tracker}: {error}")

    def meanwhile(self, step):
        """What runs beside the step: gives its environment, and which ports stand for the usual ones."""
        if step.serves:
            return serving(step.serves, self.folder, self.environment)
        if step.tracker:
            return tracking(step.tracker, self.folder, self.environment)
        return nullcontext((self.environment, {}))

    def python_command(self, step):
        """One program of this block and the page's blocks before it."""
        self.blocks.append(self.folder / f".block{len(self.blocks)}.py")
        self.blocks[-1].write_text(f"{self.path}:{step.line}\n" + "\n".join(step.lines) + "\n")
        driver = Path(__file__).with_name("python_blocks.py")
        return " ".join(["exec", sys.executable, "-B", str(driver), *(block.name for block in self.blocks)])

    def run_commands(self, step, commands, printed, environment):
        for command in commands:
            reason = next((why for beginning, why in step.skip if command.startswith(beginning)), None)
            if reason:
                self.passed_over.append((1, reason))
                continue
            start = time.monotonic()
            code, output = self.execute(runnable(command), environment)
            if time.monotonic() - start > SLOW_SECONDS:
                self.slow.append((time.monotonic() - start, command))
            printed.extend(output.splitlines())
            if code != step.exit_code:
                return self.fail(step, f"exit code {code}: {command}\n{output}")
            self.ran += step.kind != "setup"
        return True

    def execute(self, command, environment):
        """Exit code and all that was printed."""
        try:
            done = subprocess.run(["bash", "-c", command], cwd=self.folder, env=environment, timeout=MOST_SECONDS,
                                  stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            return done.returncode, done.stdout
        except subprocess.TimeoutExpired:
            return "none", f"it did not end within {MOST_SECONDS} s"

    def fail(self, step, what):
        self.failure = f"{self.path}:{step.line}: {what}"
        return False


def run_page(path, source, environment):
    with tempfile.TemporaryDirectory(prefix="palpate-docs-") as folder:
        os.symlink(source / "examples", Path(folder) / "examples")
        Path(folder, ".curlrc").write_text(CURL_SAYS)
        page = Page(path, folder, dict(environment, CURL_HOME=folder))
        page.run()
        return page


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("binary", type=Path, help="the palpate that is run; its folder comes first in PATH")
    parser.add_argument("--shared", default="/nonexistent", help="folder with the shared data")
    parser.add_argument("--python", type=Path, help="folder with the module palpate; else `python` beside the binary's folder")
    parser.add_argument("pages", nargs="*", type=Path, help="all of README.md and docs/ without it")
    options = parser.parse_intermixed_args()
    source = Path(__file__).resolve().parents[2]
    pages = options.pages or [source / "README.md", *sorted((source / "docs").rglob("*.md"))]
    environment = dict(os.environ, PATH=f"{options.binary.absolute().parent}:{os.environ['PATH']}",
                       PALPATE_SHARED_DIR=str(Path(options.shared).resolve()), MPLBACKEND="Agg",
                       PALPATE_SOURCE_DIR=str(source),
                       PYTHONPATH=str((options.python or options.binary.absolute().parents[1] / "python").resolve()))
    with ThreadPoolExecutor(2) as pool:
        done = list(pool.map(lambda path: run_page(path.resolve(), source, environment), pages))

    for page in done:
        for count, reason in page.passed_over:
            print(f"not run: {page.path.relative_to(source)}: {count}: {reason}")
        for seconds, command in page.slow:
            print(f"slow: {page.path.relative_to(source)}: {seconds:.1f} s: {command}")
        if page.failure:
            print(page.failure, file=sys.stderr)
    ran = sum(page.ran for page in done)
    passed_over = sum(count for page in done for count, _ in page.passed_over)
    print(f"{ran} commands run, {passed_over} not ({100.0 * passed_over / max(1, ran + passed_over):.0f} %)")
    return 1 if ran == 0 or any(page.failure for page in done) else 0


if __name__ == "__main__":
    sys.exit(main())
