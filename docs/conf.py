# SPDX-License-Identifier: Apache-2.0
"""The site: docs/**/*.md through Sphinx and MyST. tools/docs.sh lays the pages out and calls it."""

import importlib.util
import inspect
import re
from pathlib import Path

project = "Palpate"
author = "the Palpate authors"
html_title = "Palpate"
html_theme = "furo"
html_show_sourcelink = False
html_copy_source = False
html_show_copyright = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
highlight_language = "none"  # commands and what they print, where nothing else is said
html_extra_path = ["cpp_html"]  # Doxygen's, laid there by tools/docs.sh
extensions = ["myst_parser"]
myst_heading_anchors = 4
exclude_patterns = ["cpp_html", "_static"]

SITE = Path(__file__).parent  # where tools/docs.sh has laid the pages
ROOT_PAGES = ("ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md", "NOTATION.md")  # laid into project/
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s#:]*)(#[^)\s]*)?\)")


def in_tree(docname):
    """Where a page of the site stands in the source tree."""
    if docname.startswith("project/"):
        return Path(docname[len("project/"):] + ".md")
    return Path("docs", docname + ".md")


def on_site(path):
    """Where a file of the tree stands on the site; None where it does not."""
    if path.parts[:1] == ("docs",) and path.suffix == ".md":
        return Path(*path.parts[1:])
    return Path("project", path) if str(path) in ROOT_PAGES else None


def normal(path):
    parts = []
    for part in path.parts:
        if part == "..":
            parts.pop()
        else:
            parts.append(part)
    return Path(*parts)


def to_site(docname, text):
    """Links of a page of the tree as links of the site; what is not on the site is named, not linked."""
    here = in_tree(docname)
    up = "../" * docname.count("/")

    def replaced(link):
        target = normal(here.parent / link.group(2)) if link.group(2) else here
        page = on_site(target)
        if page is not None and link.group(3) and f'<a id="{link.group(3)[1:]}">' in Path(SITE, page).read_text():
            return f'<a href="{up}{page.with_suffix(".html")}{link.group(3)}">{link.group(1)}</a>'  # MyST knows headings alone
        if page is not None:
            return f"[{link.group(1)}]({up}{page}{link.group(3) or ''})"
        return f"`{target}`" if link.group(1).strip("`") == str(target) else f"{link.group(1)} (`{target}`)"

    lines, fenced = [], False
    for line in text.splitlines():
        fenced ^= line.lstrip().startswith("```")
        lines.append(line if fenced else LINK.sub(replaced, line))
    return "\n".join(lines) + "\n"


def belongs(value, owner):
    """Not what a module has imported from elsewhere."""
    return inspect.isclass(owner) or getattr(value, "__module__", "") == owner.__name__


def told(name, thing):
    """A heading and what the thing says of itself, word by word; below it what belongs to it."""
    pages = [f"## {name}\n\n````text\n{inspect.getdoc(thing) or ''}\n````\n"]
    if inspect.isclass(thing) or inspect.ismodule(thing):
        members = [(member, getattr(thing, member)) for member in sorted(vars(thing))]
        pages += [f"### {name}.{member}\n\n````text\n{inspect.getdoc(value)}\n````\n" for member, value in members
                  if not member.startswith("_") and inspect.getdoc(value) and belongs(value, thing)]
    return "\n".join(pages)


def python_reference():
    """What `help(palpate)` says, as a page; where the module is not there, how to get it."""
    spec = importlib.util.find_spec("palpate")
    if spec is None or spec.origin is None:  # the folder of the C++ sources has the same name
        return "The Python module was not built when this page was: `pip install .` in the source tree, then `tools/docs.sh`.\n"
    import palpate  # pylint: disable=import-outside-toplevel,import-error

    names = [name for name in sorted(getattr(palpate, "__all__", dir(palpate))) if not name.startswith("_")]
    return f"````text\n{inspect.getdoc(palpate)}\n````\n\n" + "\n".join(told(n, getattr(palpate, n)) for n in names)


def on_source_read(_app, docname, source):
    text = source[0].replace("<!-- python reference -->", python_reference()) if docname == "reference/python_api" else source[0]
    source[0] = to_site(docname, text)


def setup(app):
    app.connect("source-read", on_source_read)
    return {"parallel_read_safe": True}
