#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The runner of the documentation's commands sees what it must see: pages made up, with a `palpate` that only echoes."""

import tempfile
import unittest
from pathlib import Path

import run_commands
from page import read_page

ECHO = '#!/bin/sh\n[ "$1" = fail ] && exit 2\necho "$@"\n'


class Pages(unittest.TestCase):
    def run_page(self, text):
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder) / "palpate"
            program.write_text(ECHO)
            program.chmod(0o755)
            path = Path(folder) / "page.md"
            path.write_text(text)
            environment = {"PATH": f"{folder}:/usr/bin:/bin", "PALPATE_SHARED_DIR": "/nonexistent"}
            return run_commands.run_page(path, Path(folder), environment)

    def test_a_command_that_fails_is_told_with_its_line(self):
        self.assertIn("page.md:3: exit code 2: palpate fail", self.run_page("words\n\n```\npalpate fail\n```\n").failure)
        self.assertEqual(self.run_page("\n<!-- exit: 2 -->\n```\npalpate fail\n```\n").failure, "")

    def test_output_is_compared(self):
        page = "```\npalpate error 1.00 mm\n```\n\n<!-- output -->\n```\nerror %s\n```\n"
        self.assertEqual(self.run_page(page % "1.01 mm").failure, "")
        self.assertIn("was not printed", self.run_page(page % "1.05 mm").failure)
        self.assertIn("was not printed", self.run_page(page % "1.00 m").failure)

    def test_indented_and_continued_commands_are_run(self):
        page = self.run_page("Text\n\n    palpate a \\\n      b\n    palpate c\n\nmore\n\n    no command\n")
        self.assertEqual((page.ran, page.failure), (2, ""))

    def test_set_up_is_run_and_not_counted(self):
        page = self.run_page("<!-- run: touch made -->\n\n<!-- run -->\n```\ncat made\n```\n")
        self.assertEqual((page.ran, page.failure), (1, ""))

    def test_what_is_not_run_is_counted_with_its_reason(self):
        page = self.run_page("<!-- norun: long -->\n```\npalpate fail\npalpate fail\n```\n"
                             "<!-- skip: palpate fail: short -->\n```\npalpate a\npalpate fail\n```\n")
        self.assertEqual((page.ran, page.passed_over, page.failure), (1, [(2, "long"), (1, "short")], ""))

    def test_code_in_other_languages_is_no_command(self):
        self.assertEqual(read_page("```cpp\npalpate ::x;\n```\n"), [])

    def test_a_service_ends_by_itself(self):
        self.assertIn("--for", run_commands.runnable("palpate serve --demo"))
        self.assertEqual(run_commands.runnable("palpate serve --for 8").count("--for"), 1)


if __name__ == "__main__":
    unittest.main()
