#!/usr/bin/env python3
"""memories_test.py BUILD: a firmware is linked again when its memories change, in the linker script of its board or in the part that
boards share: the build lists both as dependencies. Otherwise the next image would be flashed to the old addresses. The template's drive is
of the sizes in its robot.hpp, as its firmware is."""
import re
import sys
import unittest
from pathlib import Path

BOARDS = Path(sys.argv.pop(1)) / "board"
FIRMWARE = [("template", "robot.elf", "board.ld"), ("template", "drive.elf", "board.ld"), ("cortex-m7", "drive.elf", "mps2_an500.ld"),
            ("cortex-m7", "interrupt_test.elf", "mps2_an500.ld"), ("cortex-r5f", "drive.elf", "zcu102_r5.ld"),
            ("cortex-r5f", "bus_drive.elf", "zcu102_r5.ld"), ("cortex-r5f", "can_test.elf", "zcu102_r5.ld")]


def made_of(board, program):
    """The dependencies of the program's link step, from the files of Ninja or make."""
    ninja, make = BOARDS / board / "build.ninja", BOARDS / board / f"CMakeFiles/{program}.dir/build.make"
    text = (ninja if ninja.exists() else make).read_text().replace("$\n", "")
    start = "build " if ninja.exists() else ""
    return " ".join(re.findall(rf"^{start}{re.escape(program)}: (.*)$", text, re.MULTILINE))


class Memories(unittest.TestCase):
    def test_firmware_is_linked_anew_when_its_memories_change(self):
        for board, program, script in FIRMWARE:
            for wanted in (script, "sections.ld"):
                with self.subTest(board=board, program=program, script=wanted):
                    self.assertIn("/" + wanted, made_of(board, program))

    def test_the_templates_drive_is_of_the_robots_sizes(self):
        ninja, make = BOARDS / "template/build.ninja", BOARDS / "template/common/CMakeFiles/curbline_drive.dir/flags.make"
        self.assertIn("-DCURBLINE_ROBOT", (ninja if ninja.exists() else make).read_text())


if __name__ == "__main__":
    unittest.main()
