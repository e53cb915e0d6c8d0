#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of the documentation, page by page, as a reader would.

A code block whose first line begins with `palpate ` is run, each page in an empty folder with `examples` in it. In front of a block may stand
  <!-- run -->             run it, whatever it begins with     <!-- run: COMMAND -->  set-up that a reader does not see
  <!-- norun: reason -->   do not run it                       <!-- needs: shared --> only where the shared data is there
  <!-- skip: BEGINNING: reason -->  do not run the commands of the block that begin so
  <!-- output -->          its lines stand, in order, in what the commands before it have printed; numbers within 2 %
  <!-- prints: ... -->     each of its lines begins one that was printed           <!-- exit: 1 -->  the exit code
Exit code 1 where a command fails. The share that is not run is printed, with the reasons.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from page import read_page

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
ENDS_BY_ITSELF = " --for 1.5"  # `palpate serve` of a page would run until Ctrl-C
MOST_SECONDS, SLOW_SECONDS = 120, 5.0  # a command that does not end; one that is told
FREE_PORTS = (" --openigtlink-port", " --dashboard-port")  # other tests may hold the usual ones


def runnable(command):
    """The command as it is run: a service ends by itself and takes ports that are free."""
    if not command.startswith("palpate serve"):
        return command
    for flag in FREE_PORTS:
        command += "" if flag in command else flag + " 0"
    return command + ("" if " --for " in command else ENDS_BY_ITSELF)


def alike(said, printed):
    """The same words, and numbers within 2 % or two of the last digit that the page gives."""
    words_said, words_printed = NUMBER.split(said), NUMBER.split(printed)
    if [w.split() for w in words_said] != [w.split() for w in words_printed]:
        return False
    for a, b in zip(NUMBER.findall(said), NUMBER.findall(printed)):
        digits = len(a.split(".")[1]) if "." in a and "e" not in a.lower() else 0
        if abs(float(a) - float(b)) > max(0.02 * abs(float(a)), 2.0 * 10.0**-digits if "." in a else 0.0):
            return False
    return True


def missing_line(step, printed):
    """The first line of the step that was not printed; None where all were."""
    at = 0
    for line in step.lines:
        if step.kind == "prints":
            found = next((i for i, p in enumerate(printed) if p.startswith(line)), None)
        else:
            found = next((i for i in range(at, len(printed)) if alike(line, printed[i])), None)
            at = at if found is None else found + 1
        if found is None:
            return line
    return None


class Page:
    """A page that is run: what it did, and the first thing that went wrong."""

    def __init__(self, path, folder, environment):
        self.path, self.folder, self.environment = path, folder, environment
        self.ran, self.passed_over, self.slow, self.failure = 0, [], [], ""

    def run(self):
        printed = []
        for step in read_page(self.path.read_text()):
            if step.kind in ("output", "prints"):
                if printed is not None and (line := missing_line(step, printed)) is not None:
                    return self.fail(step, f"was not printed: {line}\n  printed:\n    " + "\n    ".join(printed))
                continue
            lacks = step.needs == "shared" and not Path(self.environment["PALPATE_SHARED_DIR"]).is_dir()
            if step.norun or lacks:
                if step.kind == "commands":
                    self.passed_over.append((len(step.lines), step.norun or "the shared data is not there"))
                printed = None
                continue
            printed = []
            if not self.run_step(step, printed):
                return None
        return None

    def run_step(self, step, printed):
        for command in step.lines:
            reason = next((why for beginning, why in step.skip if command.startswith(beginning)), None)
            if reason:
                self.passed_over.append((1, reason))
                continue
            start = time.monotonic()
            code, output = self.execute(runnable(command))
            if time.monotonic() - start > SLOW_SECONDS:
                self.slow.append((time.monotonic() - start, command))
            printed.extend(output.splitlines())
            if code != step.exit_code:
                self.fail(step, f"exit code {code}: {command}\n{output}")
                return False
            self.ran += step.kind == "commands"
        return True

    def execute(self, command):
        """Exit code and all that was printed."""
        try:
            done = subprocess.run(["bash", "-c", command], cwd=self.folder, env=self.environment, timeout=MOST_SECONDS,
                                  stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            return done.returncode, done.stdout
        except subprocess.TimeoutExpired:
            return "none", f"it did not end within {MOST_SECONDS} s"

    def fail(self, step, what):
        self.failure = f"{self.path}:{step.line}: {what}"


def run_page(path, source, environment):
    with tempfile.TemporaryDirectory(prefix="palpate-docs-") as folder:
        os.symlink(source / "examples", Path(folder) / "examples")
        page = Page(path, folder, environment)
        page.run()
        return page


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("binary", type=Path, help="the palpate that is run; its folder comes first in PATH")
    parser.add_argument("--shared", default="/nonexistent", help="folder with the shared data")
    parser.add_argument("pages", nargs="*", type=Path, help="all of README.md and docs/ without it")
    options = parser.parse_intermixed_args()
    source = Path(__file__).resolve().parents[2]
    pages = options.pages or [source / "README.md", *sorted((source / "docs").rglob("*.md"))]
    environment = dict(os.environ, PATH=f"{options.binary.absolute().parent}:{os.environ['PATH']}",
                       PALPATE_SHARED_DIR=str(Path(options.shared).resolve()))
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
