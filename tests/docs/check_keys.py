#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Keys of the TOML files: each that a reader in the code knows stands on its page, and each in the page's tables is known to a reader.

A key is a word in quotation marks in the sources that read the file. Usage: check_keys.py [--self-test]
"""

import re
import sys
from pathlib import Path

# Page, the sections of it whose tables list keys, and who reads the file.
FILES = (
    ("docs/reference/formats.md", ("## Catheter file", "## Load cases", "## Scenario file"),
     ("palpate/recording/catheter_*.cpp", "palpate/recording/load_cases.cpp", "palpate/recording/scenario_*.cpp",
      "apps/palpate/identify_stiffness_toml.cpp")),
    ("docs/reference/serve.md", ("## Settings",), ("palpate/service/settings.cpp",)),
)
NO_KEYS = {"tool"}  # words of messages
WORD = re.compile(r'"([a-zA-Z][a-zA-Z_0-9]*)"')


def section(text, heading):
    """From the heading to the next of its rank."""
    at = text.index(heading)
    end = text.find("\n## ", at + 1)
    return text[at:end if end > 0 else len(text)]


def table_keys(text):
    """Names in backticks in the cells of the first two columns; of `a.b` the last part."""
    for row in re.findall(r"^\|.*\|$", text, re.MULTILINE):
        for cell in row.split("|")[1:3]:
            for name in re.findall(r"`\[*\.?((?:\w+\.)*[a-z]\w*)\]*`", cell):
                yield name.split(".")[-1]


def differences(page, text, headings, sources):
    """One line for each key on one side alone."""
    known = set(WORD.findall(sources))
    named = set(re.findall(r"\w+", text))
    for key in sorted(known - named - NO_KEYS):
        yield f"{page}: {key} is read, and not told"
    for heading in headings:
        for key in sorted(set(table_keys(section(text, heading))) - known):
            yield f"{page}: {heading[3:]}: nobody reads {key}"


def self_test():
    page = "## File\n| key | |\n|---|---|\n| `[table]` | `one`, `table.two` |\n## Other\n| `three` | |\n"
    code = 'get("table"), get("one"), get("two")'
    assert not list(differences("p", page, ("## File",), code))
    assert list(differences("p", page, ("## File",), code.replace('"two"', "two"))) == ["p: File: nobody reads two"]
    assert list(differences("p", page, ("## File",), code + '"four"')) == ["p: four is read, and not told"]
    print("self-test passed")
    return 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    root = Path(__file__).resolve().parents[2]
    wrong, keys = [], 0
    for page, headings, patterns in FILES:
        text = (root / page).read_text()
        sources = "".join(file.read_text() for pattern in patterns for file in sorted(root.glob(pattern)))
        wrong += differences(page, text, headings, sources)
        keys += sum(len(set(table_keys(section(text, heading)))) for heading in headings)
    print("\n".join(wrong) if wrong else f"{keys} keys, all told and read")
    return 1 if wrong or keys == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
