# SPDX-License-Identifier: Apache-2.0
"""Runs the Python blocks of a page: python_blocks.py FILE..., each `PAGE:LINE` and the block.

All share one namespace, in order; what the earlier ones print was printed before, and is not printed again. A traceback names the
page and its line.
"""

import contextlib
import io
import sys
from pathlib import Path


def main(files):
    namespace = {"__name__": "__main__"}
    for number, file in enumerate(files, 1):
        place, text = Path(file).read_text(encoding="utf-8").split("\n", 1)
        page, line = place.rsplit(":", 1)
        code = compile("\n" * int(line) + text, page, "exec")  # so that line numbers are the page's
        silent = contextlib.redirect_stdout(io.StringIO()) if number < len(files) else contextlib.nullcontext()
        with silent:
            exec(code, namespace)  # pylint: disable=exec-used


if __name__ == "__main__":
    main(sys.argv[1:])
