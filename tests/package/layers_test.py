#!/usr/bin/env python3
"""Dependencies run one way: board -> port -> lib, tools -> port -> lib, and within lib in the order of the data flow (lib/README.md)."""
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WAY = ["map", "regions", "planes", "labels", "curbs"]
# What a folder of lib/curbline may include besides itself and the headers that all share.
BEFORE = {folder: WAY[:k] for k, folder in enumerate(WAY)} | {"intake": [], "can": ["intake", "curbs"]}
# Files that may include later stages: they compare a line with what earlier lines have produced.
BACK = {"map_comparison", "line_intake"}


def sources(folder):
    return [f for f in (ROOT / folder).rglob("*") if f.suffix in (".hpp", ".cpp")]


def included(file):
    return re.findall(r'#include ["<]([^">]+)[">]', file.read_text())


class Layers(unittest.TestCase):
    def test_lib_includes_itself_and_Eigen_and_the_standard_library_alone(self):
        for file in sources("lib"):
            self.assertEqual([i for i in included(file) if "/" in i and not i.startswith(("curbline/", "Eigen/"))], [], file)

    def test_a_stage_of_lib_includes_none_that_comes_after_it(self):
        self.assertEqual({f.name for f in (ROOT / "lib/curbline").iterdir() if f.is_dir()}, set(BEFORE))
        for folder, before in BEFORE.items():
            for file in sources(f"lib/curbline/{folder}"):
                stages = {i.split("/")[1] for i in included(file) if i.startswith("curbline/") and i.count("/") == 2}
                self.assertEqual(stages - {folder, *before} if file.stem not in BACK else set(), set(), file)

    def test_port_includes_nothing_of_boards_and_tools(self):
        for file in sources("port"):
            above = [i for i in included(file) if any((ROOT / top / i).exists() for top in ("board", "tools"))]
            self.assertEqual(above, [], file)


if __name__ == "__main__":
    unittest.main()
