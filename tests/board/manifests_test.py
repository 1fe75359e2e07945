#!/usr/bin/env python3
"""The manifests for other build systems are well formed and agree with the project in version, sources and flags."""
import json
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROJECT = (ROOT / "CMakeLists.txt").read_text()
VERSION = re.search(r"project\(curbline VERSION (\S+)", PROJECT)[1]
FLAGS = {"EIGEN_NO_MALLOC", "EIGEN_DONT_VECTORIZE", "EIGEN_MAX_ALIGN_BYTES=8"}


def yaml(path):
    """Reads nested maps of scalars, which is what these files contain; refuses anything else."""
    top, inner = {}, None
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if not line or line.startswith("#"):
            continue
        entry = re.fullmatch(r"(  )?(\w+):(?: (\S.*))?", line)
        if not entry or (entry[1] and inner is None):
            raise ValueError(f"{path}:{number}: expected `key: value`, at most one map deep")
        if entry[1]:
            inner[entry[2]] = entry[3].strip('"')
        elif entry[3]:
            top[entry[2]], inner = entry[3].strip('"'), None
        else:
            inner = top[entry[2]] = {}
    return top


class Manifests(unittest.TestCase):
    def test_platformio_has_the_version_the_sources_and_the_flags(self):
        manifest = json.loads((ROOT / "library.json").read_text())
        self.assertEqual(manifest["version"], VERSION)
        build = manifest["build"]
        source = ROOT / build["srcDir"]
        found = {f for pattern in build["srcFilter"] for f in source.glob(re.fullmatch(r"\+<(.*)>", pattern)[1])}
        self.assertEqual(found, set(source.rglob("*.cpp")))
        self.assertTrue((ROOT / build["includeDir"] / "curbline" / "curbline.hpp").exists())
        self.assertEqual({"-std=c++20", "-ffp-contract=off", *("-D" + f for f in FLAGS)}, set(build["flags"]))

    def test_the_zephyr_module_names_files_that_are_there(self):
        folder = ROOT / "port" / "zephyr"
        module = yaml(folder / "zephyr" / "module.yml")
        self.assertEqual(module["name"], "curbline")
        self.assertTrue((folder / module["build"]["cmake"] / "CMakeLists.txt").exists())
        kconfig = (folder / module["build"]["kconfig"]).read_text()
        self.assertIn("config CURBLINE\n", kconfig)
        self.assertIn("\tselect REQUIRES_FULL_LIBCPP\n", kconfig)  # Zephyr's minimal one has no <array>, <span>, <optional>

    def test_the_esp_idf_component_has_the_version(self):
        component = yaml(ROOT / "port" / "esp_idf" / "curbline" / "idf_component.yml")
        self.assertEqual((component["version"], component["license"]), (VERSION, "MIT"))

    def test_all_of_them_keep_the_bits_equal(self):
        for path in ("port/zephyr/CMakeLists.txt", "port/esp_idf/curbline/CMakeLists.txt"):
            text = (ROOT / path).read_text()
            self.assertTrue(all(flag in text for flag in FLAGS | {"-ffp-contract=off"}), path)


if __name__ == "__main__":
    unittest.main()
