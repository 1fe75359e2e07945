#!/usr/bin/env python3
"""Dependencies run one way: board -> port -> lib, tools -> port -> lib, and within lib in the order of the data flow (lib/README.md)."""
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WAY = ["map", "regions", "planes", "labels", "borders", "curbs"]
# What a folder of lib/curbline may include besides itself and the headers that all share.
BEFORE = {folder: WAY[:k] for k, folder in enumerate(WAY)} | {"intake": [], "can": ["intake", "curbs"]}
# Files that may include later stages: they compare a line with what earlier lines have produced.
BACK = {"map_comparison", "line_intake"}
# Headers beside the folders that put all stages together; the others are those that all share, and need no stage.
WHOLE = {"curbline", "pipeline", "workspace"}


def sources(folder):
    return [f for f in (ROOT / folder).rglob("*") if f.suffix in (".hpp", ".cpp")]


def included(file):
    return re.findall(r'#include ["<]([^">]+)[">]', file.read_text())


def stages_reached(file):
    """The folders of lib/curbline whose headers a file includes, itself or by what it includes."""
    seen, left = set(), [file]
    while left:
        new = {i for i in included(left.pop()) if i.startswith("curbline/")} - seen
        seen |= new
        left += [ROOT / "lib" / i for i in new]
    return {i.split("/")[1] for i in seen if i.count("/") == 2}


class Layers(unittest.TestCase):
    def test_lib_includes_itself_and_Eigen_and_the_standard_library_alone(self):
        for file in sources("lib"):
            self.assertEqual([i for i in included(file) if "/" in i and not i.startswith(("curbline/", "Eigen/"))], [], file)

    def test_a_stage_of_lib_includes_none_that_comes_after_it(self):
        self.assertEqual({f.name for f in (ROOT / "lib/curbline").iterdir() if f.is_dir()}, set(BEFORE))
        for folder, before in BEFORE.items():
            for file in sources(f"lib/curbline/{folder}"):
                if file.stem not in BACK:
                    self.assertEqual(stages_reached(file) - {folder, *before}, set(), file)

    def test_what_all_stages_of_lib_share_needs_none_of_them(self):
        for file in (ROOT / "lib/curbline").iterdir():
            if file.is_file() and file.stem not in WHOLE:
                self.assertEqual(stages_reached(file), set(), file)

    def test_port_includes_nothing_of_boards_and_tools(self):
        for file in sources("port"):
            above = [i for i in included(file) if any((ROOT / top / i).exists() for top in ("board", "tools"))]
            self.assertEqual(above, [], file)


if __name__ == "__main__":
    unittest.main()
