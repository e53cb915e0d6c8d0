# SPDX-License-Identifier: Apache-2.0
"""The command line that there is, from the program's own manual, and the commands that a page names."""

import re
import shlex
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from page import read_page

INLINE = re.compile(r"(?<!`)`([^`]+)`(?!`)")
ENDS = ("|", "||", "&&", "&", ";", ">", "<")  # of a command; what follows is another program's
NOT_IN_MANUAL = ("completion", "man")  # verbs for packagers, which `palpate --help` leaves out as well
ANY_VERB = re.compile(r"[A-Z]+$|\.\.\.$")  # a word that stands for any


@dataclass
class Verb:
    """`palpate` or one of its commands: flags, and whether something else than a command may follow."""

    flags: set = field(default_factory=set)
    takes_words: bool = False


def read_manual(binary):
    """All verbs by their words: ("identify", "noise")."""
    verbs = {}
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([binary, "man", "--out", folder], check=True, stdout=subprocess.DEVNULL)
        for file in Path(folder).glob("palpate*.1"):
            text = file.read_text().replace("\\-", "-")
            flags = set(re.findall(r"^(?:\\fB-\w\\fR, )?\\fB(--[\w-]+)\\fR", text, re.MULTILINE))
            verbs[tuple(file.stem.split("-")[1:])] = Verb(flags, ".SH ARGUMENTS" in text)
    for name in NOT_IN_MANUAL:
        text = subprocess.run([binary, name, "--help"], check=True, capture_output=True, text=True).stdout
        verbs[(name,)] = Verb(set(re.findall(r"^ +(?:-\w,)?(--[\w-]+)", text, re.MULTILINE)), "Positionals:" in text)
    return verbs


def words_of(command):
    """The words of a command up to the next program; of prose, which may quote badly, what blanks divide."""
    try:
        words = shlex.split(command, comments=True)
    except ValueError:
        words = command.split()
    end = next((i for i, word in enumerate(words) if word in ENDS or word.endswith(";")), len(words))
    return words[:end]


def wrong_word(command, verbs):
    """The first word of a `palpate ...` that the program does not know; None where it knows all."""
    path, open_verb = (), True  # may the next word be a verb?
    for word in words_of(command)[1:]:
        name = word.split("=")[0].rstrip(",")
        flag = re.match(r"\[?(--[\w-]+)", name)
        if flag:
            open_verb = False
            if flag.group(1) not in verbs[path].flags:
                return flag.group(1)
        elif open_verb and path + (name,) in verbs:
            path += (name,)
        elif open_verb and not verbs[path].takes_words and path in ((), ("identify",)):
            return None if ANY_VERB.match(word) else word
        elif not word.startswith("-"):
            open_verb = False
    return None


def unfenced(text):
    """The text with its fenced blocks made empty, lines kept."""
    fence, lines = None, []
    for line in text.splitlines():
        mark = re.match(r"\s*(`{3,})", line)
        if mark and fence is None:
            fence = mark.group(1)
        elif mark and line.strip() == fence:
            fence = None
        lines.append("" if fence is not None or mark else line)
    return "\n".join(lines)


def inline_code(text):
    """(line, code) of what stands in backticks in the prose, broken lines joined."""
    text = unfenced(text)
    at = 0
    for paragraph in re.split(r"(\n\s*\n)", text):
        for found in INLINE.finditer(paragraph):
            yield text.count("\n", 0, at + found.start()) + 1, " ".join(found.group(1).split())
        at += len(paragraph)


def commands_of(text):
    """(line, command) of every `palpate ...` of a page, in blocks, set-up and prose."""
    for step in read_page(text):
        if step.kind in ("commands", "setup"):
            for command in step.lines:
                for part in re.split(r"\s(?:&&|\|\|?|;)\s", command):
                    if part.strip().startswith("palpate "):
                        yield step.line, part.strip()
    for line, code in inline_code(text):
        if code.startswith("palpate "):
            yield line, code


def sections_of(text):
    """(heading, body) of a page, a body without the sections below it of the same rank or higher."""
    parts = re.split(r"^(#+ .*)$", text, flags=re.MULTILINE)
    heads, bodies = parts[1::2], parts[2::2]
    for i, head in enumerate(heads):
        rank, body = len(head.split(" ")[0]), bodies[i]
        for below, more in zip(heads[i + 1:], bodies[i + 1:]):
            if len(below.split(" ")[0]) <= rank:
                break
            body += more
        yield head, body
