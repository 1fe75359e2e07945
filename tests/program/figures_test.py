#!/usr/bin/env python3
"""What the scripts that score many scenes make of the scores: a program that stands in for curbline gives scores that all differ, and the
tables must hold the right ones, weighted and scaled. Only scoring is left out; a run with curbline itself is in CMakeLists.txt."""
import argparse
import importlib.machinery
import importlib.util
import json
import os
import random
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

TOOLS = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", "tools"))
sys.dont_write_bytecode = True
sys.path.insert(0, TOOLS)

# Prints scores.json for an evaluation, by the first key that is part of its words, and notes what it was asked to simulate.
STAND_IN = """#!/usr/bin/env python3
import json, os, sys
here, words = os.path.dirname(os.path.abspath(__file__)), " ".join(sys.argv[1:])
if sys.argv[1] == "simulate":
    robot = open(sys.argv[sys.argv.index("--robot") + 1]).read()
    open(os.path.join(here, "simulated"), "a").write(json.dumps([words, robot]) + "\\n")
if sys.argv[1] == "evaluate":
    scores = json.load(open(os.path.join(here, "scores.json")))
    print(json.dumps(next(value for key, value in scores.items() if key in words)))
"""


def module(name):
    loader = importlib.machinery.SourceFileLoader(name.replace("-", "_"), os.path.join(TOOLS, name))
    spec = importlib.util.spec_from_loader(loader.name, loader)
    loaded = importlib.util.module_from_spec(spec)
    loader.exec_module(loaded)
    return loaded


def run(script, scores, *words):
    """The rows of the table that a script prints, as {title: cells}, and what was simulated."""
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, "curbline")
        with open(program, "w") as file:
            file.write(STAND_IN)
        os.chmod(program, 0o700)
        with open(os.path.join(folder, "scores.json"), "w") as file:
            json.dump(scores, file)
        done = subprocess.run([sys.executable, os.path.join(TOOLS, script), *words, "--out", os.path.join(folder, "out")],
                              env={**os.environ, "CURBLINE": program}, capture_output=True, text=True, timeout=60)
        if done.returncode != 0:
            raise AssertionError(f"{script}: exit status {done.returncode}: {done.stderr}")
        with open(os.path.join(folder, "simulated")) as file:
            simulated = [json.loads(line) for line in file]
    rows = {line[:32].rstrip(): line[32:].split() for line in done.stdout.splitlines()}
    return {**rows, **{line[:36].rstrip(): line[36:].split() for line in done.stdout.splitlines()}}, simulated


def band(recall, true, precision, found):
    return {"recall": recall, "true_samples": true, "precision": precision, "found_samples": found}


def calibration(mean_square, within_1_sd, within_2_sd, pieces):
    return {"mean_square": mean_square, "within_1_sd": within_1_sd, "within_2_sd": within_2_sd, "pieces": pieces}


def street_scores(v, low, high, precision, wrong_way, errors, time_s, heights, positions):
    names = ["position_error_median_m", "position_error_95_m", "height_error_median_m", "height_error_95_m", "plane_rmse_m"]
    return {"v": v, "v_readings": v - 0.1, "step_bands": [band(*low), band(*high)], "steps": [{}, {"precision": precision}],
            "wrong_way": wrong_way, **dict(zip(names, errors)), "time_to_detection_median_s": time_s,
            "calibration": calibration(*heights), "position_calibration": calibration(*positions)}


STREETS = {"-7 ": street_scores(0.4, (0.5, 10, 0.6, 20), (0.9, 100, 0.95, 60), 0.91, 0.0, (0.010, 0.02, 0.001, 0.005, 0.002), 0.1,
                                (0.8, 0.6, 0.92, 1), (1.0, 0.5, 0.8, 1)),
           "-8 ": street_scores(0.9, (0.7, 30, 0.8, 20), (1.0, 300, 0.99, 180), 0.98, 0.1, (0.020, 0.04, 0.003, 0.007, 0.004), 0.3,
                                (1.2, 0.8, 0.96, 3), (2.0, 0.7, 1.0, 3))}
WANTED = {"V-measure": "0.650", "          of readings alone": "0.550", "streets with V below 0.5": "1",
          "recall of 4 cm and more, at 0.1 m": "0.975", "precision of 4 cm and more": "0.980", "recall of 2 to 4 cm": "0.650",
          "precision of 2 to 4 cm": "0.700", "precision of all steps": "0.960", "steps told up for down, or reverse": "0.0714",
          "position error, median, cm": "1.50", "position error, 95 %, cm": "3.00", "height error, median, mm": "2.00",
          "height error, 95 %, mm": "6.00", "planes, RMSE, mm": "3.00", "(error / sd)^2 of heights, mean": "1.10",
          "(error / sd)^2 of positions, mean": "1.75", "time to detection, median, s": "0.20"}


class Figures(unittest.TestCase):
    def test_streets_pools_rates_over_samples_and_scales_each_row(self):
        rows, _ = run("streets", {key.strip() + " --method": value for key, value in STREETS.items()}, "2", "7")
        for title, wanted in WANTED.items():
            self.assertEqual(rows[title][:3], [wanted] * 3, title)

    def test_streets_simulates_each_street_by_each_laser_with_a_late_servo(self):
        for option, scene in [([], "random:"), (["--drive"], "random-drive:"), (["--jumps"], "random-drive:")]:
            _, simulated = run("streets", {key.strip() + " --method": value for key, value in STREETS.items()}, "2", "7", *option)
            self.assertEqual(len(simulated), 6)
            for (words, robot), seed in zip(simulated, [7, 8] * 3):
                self.assertIn(f"--scene {scene}{seed} ", words)
                self.assertIn(f"--seed {seed} ", words)
                self.assertIn(f"[simulated]\ntilt_latency_s = {random.Random(seed).uniform(0, 0.02):.6f}\n", robot)
                self.assertEqual("pose_jump_every_s = 1.5" in robot, option == ["--jumps"])
            models = ["utm" if "utm" in robot else "151" if "lms-151" in robot else "200" for _, robot in simulated]
            self.assertEqual(models, ["utm", "utm", "151", "151", "200", "200"])

    def test_paper_has_each_methods_scores_in_its_own_column(self):
        methods = module("scoring.py").METHODS
        scores = {f"--method {m} ": {"v": 0.1 * k, "v_readings": 0.1 * k + 0.01, "plane_rmse_m": 0.001 * k,
                                     "plane_slope_error_median_rad": 0.002 * k, "position_error_median_m": 0.003 * k,
                                     "height_error_median_m": 0.004 * k,
                                     "steps": [{}, {"precision": 0.1 * k + 0.02, "recall": 0.1 * k + 0.03, "f1": 0.1 * k + 0.04}]}
                  for k, m in enumerate(methods, 1)}
        recorded = {key: {"crf-em": 0.1 * k, "curbline": 0.1 * k + 0.05} for k, key in enumerate(["v_same_place", "v_all", "rmse_m"], 1)}
        with tempfile.TemporaryDirectory() as data:
            for ending in [".xyz", ".gt"]:
                open(os.path.join(data, "scan-03" + ending), "w").close()
            rows, _ = run("paper", {"--paper": recorded, **scores}, data, "--seeds", "1")
        each = range(1, len(methods) + 1)
        for title, scale, offset, decimals in [("V-measure", 0.1, 0, 3), ("steps at 0.1 m: precision", 0.1, 0.02, 3),
                                               ("                recall", 0.1, 0.03, 3), ("planes, RMSE, mm", 1, 0, 1),
                                               ("position error, median, cm", 0.3, 0, 1), ("height error, median, mm", 4, 0, 1)]:
            self.assertEqual(rows[title], [f"{scale * k + offset:.{decimals}f}" for k in each], title)
        self.assertEqual(rows["V, scan-03 to scan-12"], ["0.960", "0.100", "0.150"])
        self.assertEqual(rows["V, all clouds here"][-2:], ["0.200", "0.250"])

    def test_paper_counts_a_method_that_finds_no_step_where_there_are_some_with_an_f1_of_0(self):
        paper = module("paper")
        f1 = next(value for name, value, _, _ in paper.ROWS if name.endswith("F1"))
        scores = lambda *rates: {"steps": [{}, dict(zip(["precision", "recall", "f1"], rates))]}
        self.assertEqual(f1(scores(0.5, 1.0, 2 / 3)), 2 / 3)
        self.assertEqual(f1(scores(None, 0.0, None)), 0)  # nothing found
        self.assertEqual(f1(scores(0.0, None, None)), 0)  # nothing to find, and something found
        self.assertIsNone(f1(scores(None, None, None)))

    def test_long_drive_compares_the_first_100_m_with_the_last(self):
        drive, stretches = module("long-drive"), []
        lines = [{"x_m": x, "take_s": 1e-6 * x, "evidences": x, "messages": 2 * x, "dropped": 0, "full": 0, "deferred": 1} for x in range(400)]

        def scored(_, directory):
            k = {"first": 1, "last": 2, "drive": 3}[os.path.basename(directory)]
            return {"step_bands": [band(0.1 * k, 40 * k, 0.2 * k, 40), band(0.3 * k, 20 * k, 0.15 * k, 60)],
                    "position_error_median_m": 0.01 * k, "height_error_median_m": 0.001 * k, "calibration": {"mean_square": 0.5 * k}}

        def replayed(directory, *words):
            if words:
                with open(words[words.index("--line-costs") + 1], "w") as file:
                    file.write(",".join(lines[0]) + "\n" + "".join(",".join(map(str, row.values())) + "\n" for row in lines))
                with open(words[words.index("--curbs") + 1], "w") as file:
                    file.write("height_sd_m\n0.1\nnan\n")
            return {"tilt_latency_offset_s": 0.01}, 1000 + len(directory)

        def cut(_, __, directory, begin_m, end_m):
            stretches.append((os.path.basename(directory), begin_m, end_m))
            return 0

        with tempfile.TemporaryDirectory() as out, unittest.mock.patch.multiple(
                drive, run=lambda *words: "", run_json=scored, replay=replayed, cut=cut), unittest.mock.patch("builtins.print") as said:
            logs = os.path.join(out, "logs")
            os.mkdir(logs)
            drive.measure(argparse.Namespace(out=out, metres=400, laser="utm30lx", seed=1), logs)
            with open(os.path.join(out, "long-drive.json")) as file:
                figures = json.load(file)
        self.assertEqual(stretches, [("first", 0, 100), ("last", 300, 400)])
        rows = {line[:36].rstrip(): line[36:].split() for line in (str(c.args[0]) for c in said.call_args_list if c.args)}
        self.assertEqual(rows["recall of 4 cm and more, at 0.1 m"], ["0.300", "0.600", "0.900"])
        self.assertEqual(rows["precision of 4 cm and more"], ["0.150", "0.300", "0.450"])
        self.assertEqual(rows["recall of 2 to 4 cm"], ["0.100", "0.200", "0.300"])
        self.assertEqual(rows["position error, median, cm"], ["1.00", "2.00", "3.00"])
        self.assertEqual(rows["height error, median, mm"], ["1.00", "2.00", "3.00"])
        self.assertEqual(rows["plane evidences a line"], ["49.5", "349.5", "199.5"])
        self.assertEqual(rows["labels deferred"], ["100", "100", "400"])
        self.assertEqual(rows["curbs without a deviation"], ["0", "0", "1"])
        self.assertAlmostEqual(figures["last_to_first"]["line_messages"], 349.5 / 49.5)


if __name__ == "__main__":
    unittest.main()
