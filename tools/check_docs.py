#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every link of a Markdown page to a file of the tree, and every anchor in it, leads somewhere.

Anchors are made as GitHub and MyST make them: the heading in lower case, spaces as hyphens, without punctuation.
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


def markdown_pages(root):
    """What Git knows, or would take: not the build tree, nor what npm brought."""
    listed = subprocess.run(["git", "-C", str(root), "ls-files", "-co", "--exclude-standard", "*.md"], check=False,
                            capture_output=True, text=True)
    if listed.returncode == 0:
        return sorted(root / name for name in listed.stdout.splitlines() if (root / name).exists())
    return sorted([*root.glob("*.md"), *root.glob("docs/**/*.md")])


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder).resolve()
        (root / "a.md").write_text("# One: a `thing`\n## Same\n## Same\n```\n# no heading\n[x](no.md)\n```\n`[x](no.md)`\n")
        (root / "b.md").write_text("[g](a.md#one-a-thing) [g](a.md#same-1) [w](https://x.y/z)\n[b](c.md)\n"
                                   "[b](a.md#no-heading)\n![b](p.svg)\n[b](../out.md)\n[b](#here)\n")
        lines = [broken.split(": ")[0] for broken in broken_links(root, [root / "a.md", root / "b.md"])]
        assert lines == ["b.md:2", "b.md:3", "b.md:4", "b.md:5", "b.md:6"], lines
    print("self-test passed")
    return 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    root = Path(__file__).resolve().parents[1]
    pages = markdown_pages(root)
    broken = list(broken_links(root, pages))
    print("\n".join(broken) if broken else f"{len(pages)} pages, every link leads somewhere")
    return 1 if broken or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
