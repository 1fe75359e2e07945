#!/usr/bin/env python3
"""desk_test.py BUILD: the desk's drive.elf says in one line which of its files is wrong, and what of it."""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(sys.argv[1]).resolve()
ROBOT = (ROOT / "tools/robots/utm30lx.toml").read_text()


class Desk(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_program(self, program, *words):
        return subprocess.run([BUILD / program, *words], cwd=self.folder, capture_output=True, text=True, timeout=60)

    def drive(self, robot=ROBOT):
        (self.folder / "robot.toml").write_text(robot)
        for words in [("bin/curbline", "simulate", "--scene", "street", "--robot", "robot.toml", "--duration", "0.2", "--out", "logs"),
                      ("bin/curbline-drive-log", "write", "--robot", "robot.toml", "--scans", "logs/scans.carmen", "--can", "logs/can.log",
                       "--out", "street.drive")]:
            done = self.run_program(*words)
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def refuses(self, says, *words):
        done = self.run_program("board/x86-64-gcc/drive.elf", *words)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (1, "", says + "\n"))

    def test_results_that_cannot_be_written_are_named_not_the_drive(self):
        self.drive()
        self.refuses("/dev/full: cannot be written: No space left on device", "street.drive", "/dev/full")
        self.refuses("none/results: cannot be written: No such file or directory", "street.drive", "none/results")

    def test_a_drive_that_cannot_be_read_or_is_none(self):
        self.refuses("none: cannot be read: No such file or directory; expected a stream of curbline-drive-log", "none", "results")
        (self.folder / "empty").touch()
        self.refuses("empty: the first record is not the setup; expected a stream of curbline-drive-log", "empty", "results")

    def test_a_drive_that_is_cut_or_damaged_is_told_with_the_byte_and_what_was_expected(self):
        self.drive()
        whole = (self.folder / "street.drive").read_bytes()
        setup = 8 + int.from_bytes(whole[4:8], "little")
        for bytes_left, missing in [(20, setup - 20), (setup + 3, 5), (len(whole) - 1, 1)]:
            (self.folder / "cut.drive").write_bytes(whole[:bytes_left])
            self.refuses(f"cut.drive: byte {bytes_left}: a record is cut; expected the rest of it, {missing} more bytes", "cut.drive", "results")
        for kind, bytes_of_it, says in [(9, 8, "a record of unknown kind; expected one of curbline-drive-log"),
                                        (2, 3, "a record is cut; expected one of its kind's length")]:
            (self.folder / "bad.drive").write_bytes(whole[:setup] + kind.to_bytes(4, "little") + bytes_of_it.to_bytes(4, "little") + bytes(8))
            self.refuses(f"bad.drive: byte {setup + 8}: {says}", "bad.drive", "results")

    def test_the_setting_that_the_boards_limits_refuse_is_named(self):
        self.drive(re.sub(r"(?m)^\[window\]$", "[window]\nrows = 200", ROBOT))
        says = "the pipeline refuses the settings"
        self.refuses(f"street.drive: {says}: window.rows; expected what lib/curbline/settings.hpp says of it, and the limits of this build",
                     "street.drive", "results")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
