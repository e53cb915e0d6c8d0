#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every name in the code column of NOTATION.md stands in a header, members in one that knows their class, with the unit that it ends in;
every equation number of the theory pages is one of the paper's. Usage: check_notation.py [--self-test]
"""

import re
import sys
from pathlib import Path

LAST_EQUATION = 20  # of the paper
UNITS = {"m": "m", "N": "N", "Nm": "N m", "Nm2": "N m^2", "per_m": "1/m", "N_per_m": "N/m", "s": "s", "per_N": "rad/N", "m_per_N": "m/N"}
SUFFIX = re.compile(r"_(m_per_N|N_per_m|per_m|per_N|Nm2|Nm|N|m|s)$")


def rows_of(text):
    """(symbol, code names, unit) of the table of symbols."""
    for line in text[text.index("## Symbols"):].splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 6 and "`" in cells[1]:
            yield cells[0], re.findall(r"`([^`]+)`", cells[1]), cells[2]


def wrong_names(text, headers):
    """One line for each name that no header has, and each that ends in another unit than the table says."""
    for symbol, names, unit in rows_of(text):
        owner = ""
        for name in names:
            parts = re.split(r"::|\.", name)
            owner = parts[0] if len(parts) > 1 else owner
            known = any(all(re.search(rf"\b{part}\b", header) for part in {parts[-1], parts[0], owner or parts[0]})
                        for header in headers)
            if not known:
                yield f"{symbol}: `{name}` stands in no header" + (f" with {owner}" if owner else "")
            suffix = SUFFIX.search(parts[-1])
            if suffix and UNITS[suffix.group(1)] not in [one.strip() for one in unit.split(",")]:
                yield f"{symbol}: `{name}` does not end in its unit, {unit}"


def wrong_equations(name, text):
    """One line for each "Eq. (n)" that the paper has not."""
    for found in re.finditer(r"Eqs?\. ?\((\d+)\)(?:(?:, | and |-)\((\d+)\))*", text):
        if any(int(n) > LAST_EQUATION or int(n) < 1 for n in re.findall(r"\((\d+)\)", found.group())):
            yield f"{name}: {found.group()}: the paper's last equation is ({LAST_EQUATION})"


def self_test():
    table = "## Symbols\n| F | `Load::force_N`, `moment_Nm` | N, N m | 3 | force | (9) |\n"
    headers = ["struct Load { Vector3d force_N, moment_Nm; };", "double other_m;"]
    assert not list(wrong_names(table, headers))
    assert len(list(wrong_names(table.replace("force_N", "push_N"), headers))) == 1
    assert len(list(wrong_names(table.replace("moment_Nm", "other_m"), headers))) == 2  # another class's, another unit
    assert not list(wrong_equations("p", "Eq. (20), Eqs. (14)-(16)"))
    assert len(list(wrong_equations("p", "Eq. (21)"))) == 1
    print("self-test passed")
    return 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    root = Path(__file__).resolve().parents[2]
    notation = (root / "NOTATION.md").read_text()
    wrong = list(wrong_names(notation, [file.read_text() for file in (root / "palpate").rglob("*.hpp")]))
    sources = [*(root / "docs" / "theory").glob("*.md"), *(root / "palpate").rglob("*.[hc]pp")]
    for file in sources:
        wrong += wrong_equations(file.relative_to(root), file.read_text())
    print("\n".join(wrong) if wrong else f"{len(list(rows_of(notation)))} symbols are in the code")
    return 1 if wrong or not list(rows_of(notation)) else 0


if __name__ == "__main__":
    sys.exit(main())
