#!/usr/bin/env python3
"""Scripts refuse wrong usage before they begin: one line, exit status 2, nothing written. What stops a script that scores many scenes later
is reported in one line too, with exit status 1, and earlier figures are kept."""
import glob
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest
import unittest.mock

TOOLS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tools")
DATA = os.path.join(TOOLS, "..", "..", "shared", "data", "clausius")


def program_in(folder, commands):
    """A shell script of these commands that stands in for curbline."""
    program = os.path.join(folder, "curbline")
    with open(program, "w") as file:
        file.write("#!/bin/sh\n" + commands)
    os.chmod(program, 0o700)
    return program


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
        self.refuses("left", "turned", "left")
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
        self.refuses("no clouds|no score", "turned", "--data", "/")

    def test_beginnings_of_options_and_options_given_twice(self):
        for script, words, says in [("streets", ["1", "--jump"], "unrecognized arguments: --jump"),
                                    ("turned", ["--meth=em"], "unrecognized arguments: --meth=em"),
                                    ("streets", ["1", "--drive", "--drive"], "--drive: given twice; expected once"),
                                    ("paper", ["--seeds", "1", "--seeds=2"], "--seeds: given twice; expected once"),
                                    ("long-drive", ["--keep", "--out", "a", "--out", "b"], "--out: given twice; expected once")]:
            with tempfile.TemporaryDirectory() as folder:
                done = subprocess.run([sys.executable, os.path.join(TOOLS, script), *words], cwd=folder, timeout=5,
                                      env={**os.environ, "CURBLINE": "/none/curbline"}, capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stdout, done.stderr), (2, "", f"{script}: {says}\n"))
                self.assertEqual(os.listdir(folder), [])

    def shell(self, script, *words):
        done = subprocess.run([os.path.join(TOOLS, script), *words], capture_output=True, text=True, timeout=5)
        return done.returncode, done.stdout, done.stderr

    def test_words_that_shell_scripts_do_not_know_before_they_do_anything(self):
        nothing = {"budget": "--keep, or nothing", "build": "a folder to build into, or nothing", "demo": "nothing", "setup": "nothing"}
        for script, expected in nothing.items():
            for words in [["--kep"], ["--keep", "--keep"]]:
                self.assertEqual(self.shell(script, *words), (2, "", f"{script}: {' '.join(words)}; expected {expected}\n"))
        self.assertEqual(self.shell("bench", "--benchmark_filter=x", "--kep"),
                         (2, "", "bench: --kep; expected options of Google Benchmark, such as --benchmark_filter=NAME\n"))
        self.assertEqual(self.shell("test", "kep"), (2, "", "test: kep; expected options of ctest, such as -R NAME\n"))
        self.assertEqual(self.shell("with-vcan", "--kep"),
                         (2, "", "with-vcan: --kep: expected a command; with-vcan [--timeout SECONDS] COMMAND [ARGUMENT...]\n"))
        for words in [["0", "true"], ["00", "true"], ["-1", "true"], ["1.5", "true"], ["", "true"], []]:
            self.assertEqual(self.shell("with-vcan", "--timeout", *words), (2, "", "with-vcan: --timeout: expected whole seconds, 1 or more\n"))

    def test_help_of_shell_scripts_is_their_head(self):
        for script in ["bench", "budget", "build", "demo", "setup", "test", "with-vcan"]:
            with open(os.path.join(TOOLS, script)) as file:
                head = file.read().split("set -eu\n")[0].splitlines()[1:]
            text = "".join(line[2:] + "\n" for line in head)
            for word in ["--help", "-h"]:
                self.assertEqual(self.shell(script, word), (0, text, ""))

    def test_a_folder_that_a_plain_cmake_has_configured_is_built_as_one_of_tools_build_is(self):
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(os.path.join(folder, "tools"))
            script = shutil.copy(os.path.join(TOOLS, "build"), os.path.join(folder, "tools"))
            for name, text in [("tools/setup", "#!/bin/sh\n"), ("CMakeLists.txt", "cmake_minimum_required(VERSION 3.25)\nproject(small LANGUAGES NONE)\n"
                                "add_custom_target(part ALL COMMAND ${CMAKE_COMMAND} -E touch part)\n")]:
                with open(os.path.join(folder, name), "w") as file:
                    file.write(text)
            os.chmod(os.path.join(folder, "tools", "setup"), 0o700)
            plain = os.path.join(folder, "build")
            subprocess.run(["cmake", "-G", "Unix Makefiles", "-S", folder, "-B", plain], check=True, capture_output=True, timeout=30)
            for words, build in [([], plain), ([os.path.join(folder, "new")], os.path.join(folder, "new"))]:
                done = subprocess.run([script, *words], capture_output=True, text=True, timeout=30)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertTrue(os.path.exists(os.path.join(build, "part")))

    def stopped(self, script, folder, status=1, program=sys.argv[1], stdout=subprocess.DEVNULL, interrupted_at=None):
        """Runs a script that must stop with this status; returns its error output."""
        words = {"streets": ["1"], "paper": ["--seeds", "1"], "long-drive": ["200"]}[script]
        running = subprocess.Popen([sys.executable, os.path.join(TOOLS, script), *words, "--out", folder], text=True, stdout=stdout,
                                   env={**os.environ, "CURBLINE": program}, stderr=subprocess.PIPE, start_new_session=True)
        if interrupted_at is not None:
            give_up = time.monotonic() + 30
            while not os.path.exists(interrupted_at) and time.monotonic() < give_up:
                time.sleep(0.01)
            os.killpg(running.pid, signal.SIGINT)  # to the script and what it runs, as a terminal does
        error = running.communicate(timeout=60)[1]
        self.assertEqual(running.returncode, status, error)
        self.assertEqual(error.count("\n"), 1, error)
        self.assertEqual(glob.glob(os.path.join(folder, "**", "*.part"), recursive=True), [])
        return error

    def test_a_program_that_is_another(self):
        for script in ["streets", "paper", "long-drive"]:
            with tempfile.TemporaryDirectory() as folder:
                self.assertRegex(self.stopped(script, folder, program="/bin/true"), "^/bin/true .*: no JSON .*; expected curbline\n$")

    def test_a_program_that_fails(self):
        with tempfile.TemporaryDirectory() as folder:
            program = program_in(folder, '[ "$1" = replay ] || [ -z "$ONLY_REPLAY" ] || exit 0\n'
                                 'echo "scans.carmen: cannot be written: it rains; expected room for it" >&2\nexit 1\n')
            for script in ["streets", "paper", "long-drive"]:
                error = self.stopped(script, os.path.join(folder, script), program=program)
                self.assertRegex(error, "^scans.carmen: cannot be written: it rains; expected room for it: exit status 1 of curbline [a-z]+ ")
            with unittest.mock.patch.dict(os.environ, {"ONLY_REPLAY": "1"}):
                error = self.stopped("long-drive", os.path.join(folder, "long-drive"), program=program)
                self.assertIn("it rains; expected room for it: exit status 1 of curbline replay ", error)

    def test_clouds_that_cannot_be_read_or_tell_nothing(self):
        if not os.path.isdir(DATA):
            return print(f"SKIPPED: no scorer beside the data set at {DATA}")
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(DATA, "scan-08.gt")) as file:
                regions = file.read()
            for cloud, truth, status, told in [("0 0 0\nzero 0 0\n", regions, 1, "turned: .*a.xyz: .*; expected what the scorer reads\n"),
                                               ("0 0 0\n", regions, 2, "turned: --data .*: no window .*; expected clouds with some\n")]:
                for name, text in [("a.xyz", cloud), ("a.gt", truth)]:
                    with open(os.path.join(folder, name), "w") as file:
                        file.write(text)
                words = [sys.executable, os.path.join(TOOLS, "turned"), "0", "--data", folder, "--out", os.path.join(folder, "out")]
                done = subprocess.run(words, env={**os.environ, "CURBLINE": sys.argv[1]}, capture_output=True, text=True, timeout=60)
                self.assertEqual(done.returncode, status)
                self.assertRegex(done.stderr, f"^{told}$")

    def test_a_long_drive_leaves_what_is_not_its_own(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ["first", "last", "logs"]:
                os.mkdir(os.path.join(folder, name))
                with open(os.path.join(folder, name, "curbs.csv"), "w") as file:
                    file.write("mine\n")
            failing = program_in(folder, "echo it rains >&2; exit 1\n")
            words = [sys.executable, os.path.join(TOOLS, "long-drive"), "200", "--out", folder]
            # The shortest drive that has a beginning and an end, with the laser that has the fewest beams.
            for program, more, status in [(sys.argv[1], ["--laser", "lms200"], 0), (failing, [], 1), (sys.argv[1], ["--keep"], 2)]:
                done = subprocess.run([*words, *more], env={**os.environ, "CURBLINE": program}, capture_output=True, text=True, timeout=200)
                self.assertEqual(done.returncode, status, done.stderr)
                if status == 0:
                    self.assertRegex(done.stdout, "lines dropped +0 +0 +0\nstorage full +0 +0 +0\n")
                for name in ["first", "last", "logs"]:
                    self.assertEqual(os.listdir(os.path.join(folder, name)), ["curbs.csv"])
                self.assertEqual(glob.glob(os.path.join(folder, "logs-*")), [])
            self.assertRegex(done.stderr, "^long-drive: .*/logs: there already; expected nothing there, for the logs to be kept\n$")

    def test_turned_clouds_are_scored_in_all_their_windows(self):
        if not os.path.isdir(DATA):
            return print(f"SKIPPED: no data set at {DATA}")
        with tempfile.TemporaryDirectory() as folder:
            data = os.path.join(folder, "data")
            os.mkdir(data)
            for name in ["scan-08.xyz", "scan-08.gt"]:  # with a line whose tilt is mistimed
                os.symlink(os.path.abspath(os.path.join(DATA, name)), os.path.join(data, name))
            words = [sys.executable, os.path.join(TOOLS, "turned"), "0", "20", "--data", data, "--out", os.path.join(folder, "out")]
            done = subprocess.run(words, env={**os.environ, "CURBLINE": sys.argv[1]}, capture_output=True, text=True, timeout=200)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            with open(os.path.join(folder, "out", "turned.json")) as file:
                figures = json.load(file)
            self.assertEqual(list(figures), ["0", "0, mirrored", "20", "20, mirrored", "all"])
            self.assertGreater(figures["0"]["windows"], 15)
            self.assertGreater(figures["all"]["v"], 0.86)
            self.assertGreater(figures["all"]["f1"], 0.93)
            failing = program_in(folder, "echo it rains >&2; exit 1\n")
            done = subprocess.run(words, env={**os.environ, "CURBLINE": failing}, capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, "^it rains: exit status 1 of curbline map [^\n]*\n$")

    def test_a_file_or_a_directory_in_the_way(self):
        with tempfile.TemporaryDirectory() as folder:
            place = os.path.join(folder, "utm30lx-1")
            open(place, "w").close()
            self.assertEqual(self.stopped("streets", folder), f"streets: {place}: File exists\n")
        with tempfile.TemporaryDirectory() as folder:
            place = os.path.join(folder, "late.toml")
            os.mkdir(place)
            self.assertEqual(self.stopped("long-drive", folder), f"long-drive: {place}: Is a directory\n")

    def test_standard_output_that_is_full_costs_no_figures(self):
        with tempfile.TemporaryDirectory() as folder, open("/dev/full", "w") as full:
            self.assertEqual(self.stopped("streets", folder, stdout=full), "streets: standard output: No space left on device\n")
            self.assertTrue(os.path.exists(os.path.join(folder, "streets.json")))

    def test_a_full_disk_leaves_the_earlier_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "figures.json")
            with open(path, "w") as file:
                file.write("earlier")
            code = ("import resource, signal, sys; sys.path.insert(0, sys.argv[1]); sys.dont_write_bytecode = True; import scoring\n"
                    "def main():\n  with scoring.whole_file(sys.argv[2]) as file: file.write(100 * 'later')\n"
                    "signal.signal(signal.SIGXFSZ, signal.SIG_IGN); resource.setrlimit(resource.RLIMIT_FSIZE, (99, 99)); scoring.script(main)")
            done = subprocess.run([sys.executable, "-c", code, TOOLS, path], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (1, f"-c: {path}: File too large\n"))
            self.assertEqual(os.listdir(folder), ["figures.json"])
            with open(path) as file:
                self.assertEqual(file.read(), "earlier")

    def test_an_interrupt(self):
        with tempfile.TemporaryDirectory() as folder:
            program = program_in(folder, ': >"$0.began"\nexec sleep 60\n')
            for script in ["streets", "paper", "long-drive"]:
                error = self.stopped(script, os.path.join(folder, script), 130, program, interrupted_at=program + ".began")
                self.assertEqual(error, f"{script}: interrupted\n")
                os.remove(program + ".began")

    def test_a_robot_without_the_table_of_errors_is_no_robot_without_errors(self):
        sys.path.insert(0, TOOLS)
        with tempfile.TemporaryDirectory() as folder, unittest.mock.patch.object(sys, "dont_write_bytecode", True):
            import scoring
            path = os.path.join(folder, "plain.toml")
            with open(path, "w") as file:
                file.write("[laser]\n")
            with unittest.mock.patch.object(scoring, "robot", lambda name: path), self.assertRaisesRegex(SystemExit, "plain.toml: no .simulated"):
                scoring.late_robot("plain", folder, "tilt_latency_s = 0.01")

    def simulated_by_streets(self, *words):
        """The words of the first simulation that tools/streets asks for, and the description of its robot."""
        with tempfile.TemporaryDirectory() as folder:
            program = program_in(folder, f'echo "$*" >{folder}/words\nwhile [ "$1" != --robot ]; do shift; done\n'
                                 f'cp "$2" {folder}/robot.toml\nexit 1\n')
            subprocess.run([sys.executable, os.path.join(TOOLS, "streets"), *words, "--out", os.path.join(folder, "out")],
                           env={**os.environ, "CURBLINE": program}, capture_output=True, timeout=5)
            with open(os.path.join(folder, "words")) as asked, open(os.path.join(folder, "robot.toml"), "rb") as robot:
                return asked.read(), tomllib.load(robot)["simulated"]

    def test_streets_are_those_of_the_readme(self):
        asked, errors = self.simulated_by_streets("1", "7")
        self.assertIn(" --scene random:7 ", asked)
        self.assertIn(" --seed 7 ", asked)
        self.assertEqual(errors["dropout"], 0.005)
        self.assertTrue(0 < errors["tilt_latency_s"] < 0.02)
        self.assertNotIn("pose_jump_every_s", errors)
        self.assertNotEqual(errors["tilt_latency_s"], self.simulated_by_streets("1", "8")[1]["tilt_latency_s"])
        self.assertEqual(self.simulated_by_streets("1", "7", "--latency", "0")[1]["tilt_latency_s"], 0)
        for words, jumps in [(["--drive"], False), (["--jumps"], True), (["--drive", "--jumps"], True)]:
            asked, errors = self.simulated_by_streets("1", "7", *words)
            self.assertIn(" --scene random-drive:7 ", asked)
            jumped = [errors.get(f"pose_jump_{key}") for key in ["every_s", "height_m", "attitude_rad"]]
            self.assertEqual(jumped, [1.5, 0.02, 0.007] if jumps else [None] * 3)
            self.assertTrue(0 < errors["tilt_latency_s"] < 0.02)

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
