#!/usr/bin/env python3
"""cost_test.py BUILD: tools/boards/cost.py tells of a firmware and a drive what the boards' own test counts of them, fails where a budget is
exceeded, and names what it cannot run."""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BUILD = Path(sys.argv.pop(1)).resolve()
ROOT = Path(__file__).resolve().parents[2]
ELF, STREET = BUILD / "board/cortex-m7/drive.elf", BUILD / "board/drives/street.drive"
BUDGET = ROOT / "board/mps2_an500/budget.toml"


def cost(*words):
    return subprocess.run([ROOT / "tools/boards/cost.py", BUILD, *words], capture_output=True, text=True)


class Cost(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def test_the_figures_are_those_of_the_boards_own_test_and_judged_by_the_budget(self):
        counts = (BUILD / "board/results/cortex-m7/street.counts").read_text().splitlines()
        worst = max(sum(int(n) for n in line.split(",")[1:]) for line in counts)
        allowed = re.sub(r"(worst|mean) = \S+", rf"\1 = {worst}", BUDGET.read_text())
        kept = cost(ELF, STREET, "--budget", self.write("kept.toml", allowed))
        self.assertEqual((kept.returncode, kept.stderr), (0, ""))
        self.assertRegex(kept.stdout, rf"(?m)^instructions worst +{worst} +{worst} *$")
        self.assertRegex(kept.stdout, r"(?m)^ram pipeline +\d+ +163840 *$")
        over = cost(ELF, STREET, "--budget", self.write("over.toml", allowed.replace(f"worst = {worst}", f"worst = {worst - 1}")))
        self.assertEqual(over.returncode, 1)
        self.assertRegex(over.stdout, rf"(?m)^instructions worst +{worst} +{worst - 1} +EXCEEDED$")

    def test_what_cannot_be_run_is_named(self):
        self.assertEqual(cost(ELF, "nosuch.drive").stderr, "nosuch.drive: not there; expected a file\n")
        damaged = self.write("damaged.drive", "no drive")
        self.assertRegex(cost(ELF, damaged).stderr, r"^cortex-m7: drive.elf \S*/damaged.drive \S+ ended with 1: .+\n$")
        self.assertIn("cost.py BUILD ELF DRIVE", cost(ELF).stderr)


if __name__ == "__main__":
    unittest.main()
