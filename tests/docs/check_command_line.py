#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the pages say of the command line is true, and complete.

Every `palpate VERB --flag` of a page, in prose, blocks and set-up, is one that the program has; a flag that stands alone is one of some
verb. In docs/reference/formats.md every verb has a section whose heading names it, and every flag of the verb stands in it.
Usage: check_command_line.py PALPATE [--self-test]
"""

import re
import sys
from pathlib import Path

from command_words import Verb, commands_of, inline_code, read_manual, sections_of, wrong_word

# Flags of other programs that pages name alone, and where each is read; GoogleTest's own is read nowhere here.
ELSEWHERE = {"--gtest_filter": "", "--first": "tests/campaigns/force_jumps.cpp", "--allocate-every": "benchmarks/latency.cpp",
             "--runs": "tools/fuzz.sh"}
EVERYWHERE = {"--help", "--version"}


def wrong_commands(name, text, verbs):
    """One line for each verb or flag that is none."""
    for line, command in commands_of(text):
        word = wrong_word(command, verbs)
        if word:
            yield f"{name}:{line}: {command}: the program has no {word} there"
    every = set(ELSEWHERE).union(*(verb.flags for verb in verbs.values()))
    for line, code in inline_code(text):
        flag = re.match(r"--[\w-]+", code)
        if flag and flag.group() not in every:
            yield f"{name}:{line}: {code}: no verb has {flag.group()}"


def undocumented(name, text, verbs):
    """One line for each verb without a section, and each flag that its section leaves out."""
    sections = list(sections_of(text))
    for path, verb in sorted(verbs.items()):
        if not path or path == ("identify",):  # no flags of their own
            continue
        command = "`palpate " + " ".join(path) + "`"
        bodies = [body for head, body in sections if command in head]
        if not bodies:
            yield f"{name}: no section of {command}"
            continue
        named = set(re.findall(r"--[\w-]+", " ".join(bodies)))
        for flag in sorted(verb.flags - EVERYWHERE - named):
            yield f"{name}: {command}: {flag} is not told"


def self_test():
    verbs = {(): Verb(), ("identify",): Verb(), ("identify", "noise"): Verb({"--out"}, True),
             ("estimate",): Verb({"--out", "--smooth", "--help"}, True)}
    good = ["palpate estimate a.csv --out=b", "palpate identify noise x --out y", "palpate VERB --out", "palpate estimate a | other --no"]
    for command in good:
        assert not wrong_word(command, verbs), command
    for command, word in (("palpate guess", "guess"), ("palpate identify force", "force"), ("palpate estimate a --noisy", "--noisy"),
                          ("palpate identify noise --smooth", "--smooth"), ("palpate --smooth", "--smooth")):
        assert wrong_word(command, verbs) == word, command
    page = "Say `palpate\nguess`.\n\n    palpate estimate --no\n\n```\npalpate estimate a && palpate estimate --not\n```\n`--never`\n"
    found = [line.split(": the")[0] for line in wrong_commands("p", page, verbs)]
    assert found == ["p:4: palpate estimate --no", "p:6: palpate estimate --not", "p:1: palpate guess",
                     "p:9: --never: no verb has --never"], found
    told = "## `palpate estimate`\n`--out`\n### more\n`--smooth`\n## `palpate identify noise`\n"
    assert list(undocumented("f", told, verbs)) == ["f: `palpate identify noise`: --out is not told"]
    assert list(undocumented("f", told.replace("### more", "## more"), verbs))[0] == "f: `palpate estimate`: --smooth is not told"
    print("self-test passed")
    return 0


def main():
    if "--self-test" in sys.argv[1:]:
        return self_test()
    root = Path(__file__).resolve().parents[2]
    verbs = read_manual(sys.argv[1])
    wrong = []
    for page in [root / "README.md", *sorted((root / "docs").rglob("*.md"))]:
        wrong += wrong_commands(page.relative_to(root), page.read_text(), verbs)
    wrong += [f"{file}: {flag} is not read there" for flag, file in ELSEWHERE.items() if file and flag not in (root / file).read_text()]
    formats = Path("docs", "reference", "formats.md")
    wrong += undocumented(formats, (root / formats).read_text(), verbs)
    print("\n".join(wrong) if wrong else f"{len(verbs)} verbs, all told and named rightly")
    return 1 if wrong or len(verbs) < 2 else 0


if __name__ == "__main__":
    sys.exit(main())
