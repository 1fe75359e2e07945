#!/usr/bin/env python3
"""The scripts that score many scenes refuse wrong usage before they begin: one line, exit status 2, nothing written."""
import os
import signal
import subprocess
import sys
import tempfile
import unittest

TOOLS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tools")


class Scripts(unittest.TestCase):
    def refuses(self, what, script, *words, program=sys.argv[1], out="out"):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, os.path.join(TOOLS, script), *words, "--out", os.path.join(folder, out)],
                                  env={**os.environ, "CURBLINE": program}, capture_output=True, text=True, timeout=5)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertRegex(done.stderr, f"^{script}: .*{what}.*; expected .*\n$")
            self.assertEqual(done.stdout, "")
            self.assertEqual(os.listdir(folder), [])

    def test_numbers_that_make_no_sense(self):
        self.refuses("0", "streets", "0")
        self.refuses("-1", "streets", "1", "-1")
        self.refuses("ten", "streets", "ten")
        for latency in ["-5", "nan", "2"]:
            self.refuses(latency, "streets", "1", "--latency", latency)
        self.refuses("0", "paper", "--seeds", "0")
        self.refuses("-1", "long-drive", "--seed", "-1")
        self.refuses("100", "long-drive", "100")
        self.refuses("250 m", "long-drive", "250")

    def test_a_program_that_is_not_there(self):
        for script in ["streets", "paper", "long-drive"]:
            self.refuses("/none/curbline", script, program="/none/curbline")

    def test_a_place_that_cannot_be_written_to(self):
        for script in ["streets", "paper", "long-drive"]:
            self.refuses("/dev/null/x", script, out="/dev/null/x")

    def test_clouds_that_are_not_there(self):
        self.refuses("/nonexist", "paper", "/nonexist")
        self.refuses("/", "paper", "/")

    def test_a_word_that_budget_does_not_know_before_it_builds(self):
        for words in [["--kep"], ["--keep", "--keep"]]:
            done = subprocess.run([os.path.join(TOOLS, "budget"), *words], capture_output=True, text=True, timeout=5)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertEqual(done.stderr, f"budget: {' '.join(words)}; expected --keep, or nothing\n")

    def test_who_reads_no_more_gets_no_traceback(self):
        with tempfile.TemporaryDirectory() as folder:
            script = subprocess.Popen([sys.executable, os.path.join(TOOLS, "streets"), "1", "--out", folder], text=True,
                                      env={**os.environ, "CURBLINE": sys.argv[1]}, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            script.stdout.close()
            self.assertEqual(script.stderr.read(), "")
            script.stderr.close()
            self.assertEqual(script.wait(timeout=60), -signal.SIGPIPE)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
