# SPDX-License-Identifier: Apache-2.0
"""What a page of the documentation says that can be run: its code blocks, with the directives before them."""

import re
from dataclasses import dataclass, field

SHELLS = ("", "sh", "bash", "console")
COMPARED = ("output", "prints", "answer")
DIRECTIVE = re.compile(r"<!--\s*(run|norun|needs|output|prints|answer|exit|skip|serves|tracker|file)\s*(?::\s*(.*?))?\s*-->\s*$")


@dataclass
class Step:
    """One thing that a page does: commands, or what they must have printed."""

    line: int
    kind: str  # "commands", "setup", "python", "file", or one of COMPARED
    lines: list  # of "commands" one a line, else as they stand
    norun: str = ""  # why it is not run
    needs: str = ""  # what must be there for it
    serves: str = ""  # the service that runs meanwhile
    tracker: str = ""  # the recording that a tracker's server plays meanwhile
    name: str = ""  # of the file to write
    exit_code: int = 0
    skip: tuple = ()  # beginnings of commands that are not run, and why: pairs


@dataclass
class Block:
    line: int
    language: str
    lines: list = field(default_factory=list)


def joined(lines):
    """Commands, one a line: continuations joined, remarks and empty lines left out."""
    commands, open_command = [], ""
    for line in lines:
        open_command += line.strip()
        if open_command.endswith("\\"):
            open_command = open_command[:-1]
            continue
        if open_command and not open_command.startswith("#"):
            commands.append(open_command)
        open_command = ""
    return commands


def fenced(lines, start):
    """The block whose fence stands at `start`, and the line behind it."""
    mark = re.match(r"\s*(`{3,})\s*(\S*)", lines[start])
    block = Block(start + 1, mark.group(2))
    end = start + 1
    while end < len(lines) and not lines[end].strip().startswith(mark.group(1)):
        block.lines.append(lines[end])
        end += 1
    return block, end + 1


def indented(lines, start):
    """The block that begins at `start`, indented by four."""
    block, end = Block(start + 1, ""), start
    while end < len(lines) and (lines[end].startswith("    ") or not lines[end].strip()):
        block.lines.append(lines[end][4:])
        end += 1
    return block, end


def step_of(block, directives):
    """What a block is, by the directives before it and its first line; None where it is nothing to run."""
    first = next((line.strip() for line in block.lines if line.strip()), "")
    for kind in COMPARED:
        if kind in directives:
            return Step(block.line, kind, [line.rstrip() for line in block.lines if line.strip()])
    common = {"norun": directives.get("norun", ""), "needs": directives.get("needs", "")}
    if "file" in directives:
        return Step(block.line, "file", block.lines, name=directives["file"], **common)
    if block.language == "python":
        return Step(block.line, "python", block.lines, **common)
    is_command = "run" in directives or first.startswith(("palpate ", "curl "))
    if not is_command or block.language not in SHELLS:
        return None
    return Step(block.line, "commands", joined(block.lines), serves=directives.get("serves", ""), tracker=directives.get("tracker", ""),
                exit_code=int(directives.get("exit", 0)), skip=tuple(directives.get("skip", ())), **common)


def read_page(text):
    """The steps of a page, in order."""
    lines, steps, directives, at = text.splitlines(), [], {}, 0
    while at < len(lines):
        directive = DIRECTIVE.match(lines[at].strip())
        if directive and directive.group(1) == "run" and directive.group(2):
            steps.append(Step(at + 1, "setup", [directive.group(2)], needs=directives.pop("needs", "")))
        elif directive and directive.group(1) == "skip":
            directives.setdefault("skip", []).append(tuple(directive.group(2).rsplit(": ", 1)))
        elif directive:
            directives[directive.group(1)] = directive.group(2) or ""
        elif lines[at].lstrip().startswith("```") or (lines[at].startswith("    ") and lines[at].strip()
                                                      and (at == 0 or not lines[at - 1].strip()
                                                           or DIRECTIVE.match(lines[at - 1].strip()))):
            block, at = (fenced if lines[at].lstrip().startswith("```") else indented)(lines, at)
            step = step_of(block, directives)
            if step:
                steps.append(step)
            directives = {}
            continue
        at += 1
    return steps
