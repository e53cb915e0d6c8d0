#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The runner of the documentation's commands sees what it must see: pages made up, with a `palpate` that only echoes."""

import tempfile
import unittest
from pathlib import Path

import run_commands
from compare import json_values, part_of
from page import read_page

ECHO = '#!/bin/sh\n[ "$1" = fail ] && exit 2\necho "$@"\n'
# A service that answers GET /api/health to who has its token, "secret", and goes when it is told to.
SERVICE = """#!/usr/bin/env python3
import http.server, json, sys
class Answer(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        good = self.headers.get("Authorization") == "Bearer secret"
        self.send_response(200 if good else 401)
        self.end_headers()
        self.wfile.write(json.dumps({"catheters": [{"state": "LIVE", "frames": 20}]} if good else {"error": "no token"}).encode())
    def log_message(self, *_):
        pass
server = http.server.HTTPServer(("127.0.0.1", 0), Answer)
print(json.dumps({"token": "secret", "dashboard_port": server.server_port}), flush=True)
server.serve_forever()
"""


class Pages(unittest.TestCase):
    def run_page(self, text):
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder) / "palpate"
            program.write_text(ECHO)
            service = Path(folder) / "service"
            service.write_text(SERVICE)
            for file in (program, service):
                file.chmod(0o755)
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

    def test_blocks_of_python_build_upon_one_another_and_fail_with_their_line(self):
        page = "```python\nx = 2\nprint('one')\n```\n\n```python\nprint(f'{x + 1} apples')\n```\n\n<!-- output -->\n```\n%s\n```\n"
        run = self.run_page(page % "3 apples")
        self.assertEqual((run.ran, run.failure), (2, ""))
        self.assertIn("was not printed", self.run_page(page % "one").failure)
        failure = self.run_page("words\n```python\nx = 1\ny = x + z\n```\n").failure
        self.assertIn("page.md:2: exit code 1", failure)
        self.assertIn('page.md", line 4', failure)

    def test_python_without_its_module_is_passed_over(self):
        page = self.run_page("```python\nimport palpate\n```\n")
        self.assertEqual((page.ran, page.passed_over), (0, [(1, "the Python module was not built")]))

    def test_what_a_page_asks_a_service_is_asked(self):
        page = ('<!-- serves: service -->\n```\ncurl -H "Authorization: Bearer %s" http://127.0.0.1:18946/api/health\n```\n\n'
                '<!-- answer -->\n```json\n{"catheters": [{"state": "%s", "frames": 7}]}\n```\n')
        run = self.run_page(page % ("$TOKEN", "LIVE"))
        self.assertEqual((run.ran, run.failure), (1, ""))
        self.assertIn("was not printed", self.run_page(page % ("$TOKEN", "STALE")).failure)
        self.assertIn("no token", self.run_page(page % ("wrong", "LIVE")).failure)
        self.assertIn("did not start", self.run_page("<!-- serves: true -->\n```\npalpate a\n```\n").failure)

    def test_a_tracker_is_played_at_a_port_of_its_own(self):
        page = ("<!-- file: t.csv -->\n```csv\nframe,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm\n1,tip,OK,1,0,0,0,1,2,3\n```\n"
                "<!-- tracker: %s -->\n<!-- run -->\n```\n"
                "python3 -c 'import socket; s = socket.create_connection((\"127.0.0.1:18944\".split(\":\")[0], %s));"
                " print(s.recv(106)[2:26])'\n```\n<!-- prints -->\n```\nb'TRANSFORM\\x00\\x00\\x00tipToTracker'\n```\n")
        port = 'int("127.0.0.1:18944".split(":")[1])'
        self.assertEqual(self.run_page(page % ("t.csv", port)).failure, "")
        self.assertIn("did not start", self.run_page(page % ("none.csv", port)).failure)

    def test_an_answer_has_what_the_page_shows_of_it(self):
        answer = {"a": 1, "b": [{"c": "x", "d": None}, 2], "e": True}
        self.assertTrue(part_of({"a": 5, "b": [{"c": "x"}]}, answer))
        for wrong in ({"f": 1}, {"b": [{"c": "y"}]}, {"e": False}, {"a": True}, {"a": "1"}, {"b": [{"d": 1}]}, {"b": [{}, 2, 3]}):
            self.assertFalse(part_of(wrong, answer), wrong)
        self.assertEqual(json_values(['{"a": 1}{"b":', "2}"]), [{"a": 1}, {"b": 2}])
        self.assertIsNone(json_values(["no"]))

    def test_a_block_may_be_a_file_and_need_a_program(self):
        page = self.run_page("<!-- file: made.txt -->\n```toml\na = 1\n```\n<!-- run -->\n```\ncat made.txt\n```\n"
                             "<!-- output -->\n```\na = 1\n```\n"
                             "<!-- needs: no-such-program -->\n<!-- run -->\n```\nno-such-program\n```\n")
        self.assertEqual((page.ran, page.passed_over, page.failure), (1, [(1, "no-such-program is not there")], ""))

    def test_a_service_ends_by_itself(self):
        self.assertIn("--for", run_commands.runnable("palpate serve --demo"))
        self.assertEqual(run_commands.runnable("palpate serve --for 8").count("--for"), 1)


if __name__ == "__main__":
    unittest.main()
