#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Links of the Markdown pages lead somewhere, and their C++ and CMake is compiled.

Every link to a file of the tree, and every anchor in it, is there. Anchors are made as GitHub and MyST make them: the heading in
lower case, spaces as hyphens, without punctuation.

A block of C++ stands, line for line but for indents, remarks and empty lines, in a file that is built (COMPILED); a line `// ...`
stands for what was left out. A line of CMake stands in the consumer's project, whatever the target is called.
Usage: check_docs.py [--self-test]
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

LINK = re.compile(r"!?\[[^\]]*\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
HEADING = re.compile(r"^ {0,3}#{1,6}\s+(.*?)\s*#*\s*$")
FENCE = re.compile(r"^\s*(`{3,}|~{3,})")
COMPILED = {"cpp": ("examples/*.cpp", "examples/*.hpp", "tests/consumer/*.cpp"), "cmake": ("tests/consumer/CMakeLists.txt",)}
LEFT_OUT = "// ..."


def text_lines(path):
    """(number, line) of what is not inside a fenced block."""
    fence = None
    for number, line in enumerate(path.read_text().splitlines(), 1):
        mark = FENCE.match(line)
        if mark and fence is None:
            fence = mark.group(1)
        elif mark and line.strip() == fence:
            fence = None
        elif fence is None:
            yield number, line


def slug(heading):
    """The anchor of a heading."""
    heading = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)  # a link counts by its text
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def anchors(path):
    """The anchors of a page; of equal headings the second one ends in -1, and so on."""
    seen, found = {}, set()
    for _, line in text_lines(path):
        found.update(re.findall(r"<a (?:id|name)=\"([^\"]+)\"", line))
        heading = HEADING.match(line)
        if heading:
            name = slug(heading.group(1))
            count = seen.get(name, 0)
            seen[name] = count + 1
            found.add(f"{name}-{count}" if count else name)
    return found


def broken_links(root, pages):
    """One line for every link that leads nowhere."""
    for page in pages:
        for number, line in text_lines(page):
            for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
                if re.match(r"[a-z][a-z0-9+.-]*:", target):
                    continue
                file, _, anchor = target.partition("#")
                path = (page.parent / file).resolve() if file else page
                where = f"{page.relative_to(root)}:{number}: {target}"
                if not path.is_relative_to(root) or not path.exists():
                    yield f"{where}: there is no such file"
                elif anchor and path.suffix == ".md" and anchor not in anchors(path):
                    yield f"{where}: {path.relative_to(root)} has no such heading"


def code_blocks(path):
    """(number, language, lines) of every fenced block that names its language."""
    fence, block = None, None
    for number, line in enumerate(path.read_text().splitlines(), 1):
        mark = FENCE.match(line)
        if mark and fence is None:
            fence, block = mark.group(1), (number, line.strip().strip("`~").strip(), [])
        elif mark and line.strip() == fence:
            if block[1]:
                yield block
            fence = None
        elif fence is not None:
            block[2].append(line)


def bare(line, language):
    """A line without indent and remark, of CMake also without the target's name; empty where nothing is left."""
    line = line.strip()
    if language == "cpp":
        return line if line == LEFT_OUT else re.sub(r"\s*//.*$", "", line)
    return re.sub(r"^(target_\w+|add_\w+)\(\w+( \w+\.cpp)?", r"\1(TARGET", re.sub(r"\s*#.*$", "", line))


def pieces(lines, language):
    """The runs of lines that must stand together in the file: of C++ what is between two LEFT_OUT, of CMake each line."""
    found = [[]]
    for line in filter(None, (bare(line, language) for line in lines)):
        if line == LEFT_OUT or language == "cmake":
            found.append([])
        if line != LEFT_OUT:
            found[-1].append(line)
    return [piece for piece in found if piece]


def stands_in(parts, lines):
    """All parts are in the lines, in order."""
    at = 0
    for part in parts:
        at = next((i + len(part) for i in range(at, len(lines)) if lines[i:i + len(part)] == part), None)
        if at is None:
            return False
    return True


def uncompiled_blocks(root, pages):
    """One line for every block of C++ or CMake that is in no file that is built."""
    for page in pages:
        for number, language, lines in code_blocks(page):
            if language not in COMPILED:
                continue
            files = [file for pattern in COMPILED[language] for file in root.glob(pattern)]
            parts = pieces(lines, language)
            if not any(stands_in(parts, list(filter(None, (bare(line, language) for line in file.read_text().splitlines()))))
                       for file in files):
                yield f"{page.relative_to(root)}:{number}: {language}: in none of {', '.join(COMPILED[language])}"


def markdown_pages(root):
    """What Git knows, or would take: not the build tree, nor what npm brought."""
    listed = subprocess.run(["git", "-C", str(root), "ls-files", "-co", "--exclude-standard", "*.md"], check=False,
                            capture_output=True, text=True)
    if listed.returncode == 0:
        return sorted(root / name for name in listed.stdout.splitlines() if (root / name).exists())
    return sorted([*root.glob("*.md"), *root.glob("docs/**/*.md")])


def self_test_blocks(root):
    for folder in ("examples", "tests/consumer"):
        (root / folder).mkdir(parents=True)
    (root / "examples" / "a.cpp").write_text("int main() {\n  f(1);  // why\n\n  g(2);\n  h(3);\n}\n")
    (root / "tests/consumer/CMakeLists.txt").write_text("find_package(a)\nadd_executable(b c.cpp)\ntarget_link_libraries(b a)\n")
    good = ("cpp\nf(1);\ng(2);  // what", "cpp\nf(1);\n// ...\nh(3);", "cmake\nfind_package(a)\ntarget_link_libraries(x a)", "sh\nf(2)")
    bad = ("cpp\nf(1);\nh(3);", "cpp\nh(3);\n// ...\nf(1);", "cpp\nf(2);", "cmake\ntarget_link_libraries(x b)")
    for block in good + bad:
        (root / "c.md").write_text(f"words\n```{block}\n```\n")
        assert bool(list(uncompiled_blocks(root, [root / "c.md"]))) == (block in bad), block


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder).resolve()
        (root / "a.md").write_text("# One: a `thing`\n## Same\n## Same\n```\n# no heading\n[x](no.md)\n```\n`[x](no.md)`\n")
        (root / "b.md").write_text("[g](a.md#one-a-thing) [g](a.md#same-1) [w](https://x.y/z)\n[b](c.md)\n"
                                   "[b](a.md#no-heading)\n![b](p.svg)\n[b](../out.md)\n[b](#here)\n")
        lines = [broken.split(": ")[0] for broken in broken_links(root, [root / "a.md", root / "b.md"])]
        assert lines == ["b.md:2", "b.md:3", "b.md:4", "b.md:5", "b.md:6"], lines
        self_test_blocks(root)
    print("self-test passed")
    return 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    root = Path(__file__).resolve().parents[1]
    pages = markdown_pages(root)
    broken = [*broken_links(root, pages), *uncompiled_blocks(root, pages)]
    print("\n".join(broken) if broken else f"{len(pages)} pages, every link leads somewhere, C++ and CMake are compiled")
    return 1 if broken or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
