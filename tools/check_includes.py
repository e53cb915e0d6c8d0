#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the architecture: no include may point from one room of palpate/ into a room it must not know."""

import argparse
import pathlib
import re
import sys
import tempfile

# Room -> the other rooms it may include. Written out, nothing is inherited: a new arrow is a decision made here.
ALLOWED = {
    "math": set(),
    "rod": {"math"},
    "batch": {"math", "rod"},
    "sensing": {"math", "rod"},
    "estimation": {"math"},
    "observer": {"math", "rod", "sensing", "estimation"},
    "identification": {"math", "rod", "sensing", "estimation"},
    "simulation": {"math", "rod", "sensing"},
    "recording": {"math", "rod", "sensing", "observer", "simulation"},
    "evaluation": {"math", "rod", "sensing", "estimation", "observer", "recording"},
    "plot": {"math"},
    "reproduction": {"math", "rod", "sensing", "estimation", "observer", "simulation", "evaluation", "plot"},
    "store": {"math"},
    "link": {"math"},
    "ndi": {"math", "sensing"},
    "http": {"math"},
    "session": {"math", "rod", "sensing", "observer", "recording", "store"},
    "service": {"math", "rod", "sensing", "observer", "identification", "simulation", "recording", "evaluation", "session", "link", "ndi", "http"},
    "study": {"math", "rod", "sensing", "estimation", "observer", "simulation", "recording", "evaluation", "store", "plot"},
}
OUTSIDE = ("apps", "tests", "examples", "benchmarks")  # may include any room; no room may include them
CODE = (".hpp", ".cpp", ".h", ".cc", ".ipp")
SPDX = "SPDX-License-Identifier: Apache-2.0"
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def room_of(path):
    """Room of an include path or of a file under the root: its folder right below palpate/."""
    parts = pathlib.PurePosixPath(path).parts
    return parts[1] if len(parts) > 2 and parts[0] == "palpate" else None


def includes(file):
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), start=1):
        match = INCLUDE.match(line)
        if match:
            yield number, match.group(1), match.group(2)


def ours(root, file, included):
    """The include as a path from the root when it names a header of palpate/, else None."""
    if included.startswith("palpate/"):
        return included
    beside = (file.parent / included).resolve()
    inside = (root / "palpate").resolve()
    return beside.relative_to(root.resolve()).as_posix() if inside in beside.parents and beside.exists() else None


def include_faults(root, file):
    name = file.relative_to(root).as_posix()
    room = room_of(name)
    in_palpate = name.startswith("palpate/")
    for number, opening, included in includes(file):
        where = f"{name}:{number}"
        target = ours(root, file, included)
        if target and opening == '"':
            yield f'{where}: "{included}": our headers are included as <palpate/room/header.hpp>'
        if not in_palpate:
            continue
        if included.split("/")[0] in OUTSIDE:
            yield f"{where}: <{included}>: palpate/ knows nothing of {', '.join(OUTSIDE)}"
        elif target and room in ALLOWED and room_of(target) != room and room_of(target) not in ALLOWED[room]:
            known = ", ".join(sorted(ALLOWED[room])) or "no other room"
            yield f"{where}: <{included}>: {room} may include {known}"


def file_faults(root, file):
    name = file.relative_to(root).as_posix()
    if SPDX not in file.read_text(encoding="utf-8").partition("\n")[0]:
        yield f"{name}:1: the first line must say '{SPDX}'"
    if room_of(name) not in ALLOWED:
        yield f"{name}:1: stands in no known room; the rooms are listed in tools/check_includes.py"


def check(root):
    faults = []
    for top in ("palpate",) + OUTSIDE:
        for file in sorted(p for p in (root / top).rglob("*") if p.is_file()):
            if top == "palpate":
                faults += file_faults(root, file)
            if file.suffix in CODE:
                faults += include_faults(root, file)
    return faults


def self_test():
    """Plants one fault of each kind, and code without fault, in a small tree; expects exactly the planted ones."""
    head = f"// {SPDX}\n"
    tree = {
        "palpate/math/good.hpp": head + "#include <Eigen/Core>\n",
        "palpate/rod/good.hpp": head + "#include <vector>\n#include <palpate/math/good.hpp>\n",
        "palpate/observer/good.hpp": head + "#include <palpate/estimation/filter.hpp>\n#include <palpate/rod/good.hpp>\n",
        "palpate/estimation/filter.hpp": head + "\n#include <palpate/rod/good.hpp>\n",
        "palpate/simulation/world.cpp": head + "#  include <palpate/observer/good.hpp>\n",
        "palpate/rod/quotes.cpp": head + '#include "good.hpp"\n#include "palpate/math/good.hpp"\n',
        "palpate/rod/climbs.cpp": head + "#include <tests/helper.hpp>\n",
        "palpate/rod/bare.cpp": "#include <palpate/rod/good.hpp>\n",
        "palpate/attic/old.hpp": head,
        "apps/palpate/main.cpp": '#include <palpate/observer/good.hpp>\n#include "verb.hpp"\n',
        "tests/quotes_test.cpp": '#include "palpate/rod/good.hpp"\n',
    }
    expected = [
        "palpate/attic/old.hpp:1: stands in no",
        "palpate/estimation/filter.hpp:3: <palpate/rod/good.hpp>: estimation may include math",
        "palpate/rod/bare.cpp:1: the first line",
        "palpate/rod/climbs.cpp:2: <tests/helper.hpp>",
        'palpate/rod/quotes.cpp:2: "good.hpp"',
        'palpate/rod/quotes.cpp:3: "palpate/math/good.hpp"',
        "palpate/simulation/world.cpp:2: <palpate/observer/good.hpp>: simulation may include",
        'tests/quotes_test.cpp:1: "palpate/rod/good.hpp"',
    ]
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in tree.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        found = sorted(check(root))
    missed = [e for e in expected if not any(f.startswith(e) for f in found)]
    excess = [f for f in found if not any(f.startswith(e) for e in expected)]
    return [f"not found: {m}" for m in missed] + [f"found without cause: {e}" for e in excess]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    parser.add_argument("--self-test", action="store_true", help="prove on a made-up tree that faults are found")
    options = parser.parse_args()
    if not options.self_test and not (options.root / "palpate").is_dir():
        sys.exit(f"{options.root}: has no folder palpate/")
    faults = self_test() if options.self_test else check(options.root)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
