#!/usr/bin/env python3
"""Runs the checks of tools/boards on small programs that they must refuse, and on some that they must not refuse."""
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BOARDS = Path(__file__).resolve().parents[2] / "tools" / "boards"
sys.path.insert(0, str(BOARDS))
import boards  # noqa: E402
import budget  # noqa: E402
import stack  # noqa: E402
import undefined_symbols  # noqa: E402

ARM = "arm-none-eabi-"
FLAGS = ["-mcpu=cortex-m7", "-mthumb", "-std=c++20", "-O2", "-fno-exceptions", "-fcallgraph-info=su,da", "-ffreestanding"]


class Built(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def build(self, text):
        """Compiles a program of one file to an object and its call graph."""
        (self.folder / "program.cpp").write_text(text)
        program = self.folder / "program.o"
        subprocess.run([ARM + "g++", *FLAGS, "-c", "program.cpp", "-o", program], cwd=self.folder, check=True)
        return program

    def worst(self, text):
        program = self.build(text)
        return stack.CallGraph(self.folder, program, ARM).worst("root")

    def refuses(self, text, why):
        with self.assertRaisesRegex(SystemExit, why):
            self.worst(text)


class Stack(Built):
    leaf = "[[gnu::noinline]] int leaf(volatile char* p) { return p[0]; }\n"

    def test_frames_add_up_along_the_deepest_path(self):
        deep = "extern \"C\" [[gnu::noinline]] int deep() { volatile char a[200]; a[0] = 1; return leaf(a) + a[1]; }\n"
        root = "extern \"C\" int root() { volatile char a[100]; a[0] = 1; return deep() + leaf(a) + a[1]; }\n"
        bytes_, path = self.worst(self.leaf + deep + root)
        self.assertEqual(path[:2], ["root", "deep"])
        self.assertTrue(300 <= bytes_ <= 360, bytes_)

    def test_recursion_is_refused(self):
        self.refuses("int other(int);\n[[gnu::noinline]] int again(int n) { return n > 0 ? other(n - 1) * 2 + 1 : 0; }\n"
                     "[[gnu::noinline]] int other(int n) { return again(n) * 3 + 1; }\nextern \"C\" int root(int n) { return again(n); }", "recursion")

    def test_a_call_through_a_pointer_is_refused(self):
        self.refuses('extern "C" int root(int (*f)()) { return f() + 1; }', "through a pointer")

    def test_code_without_a_call_graph_is_followed_through_every_branch(self):
        deep = 'extern "C" [[gnu::noinline]] int deep(int n) { volatile char a[200]; a[0] = 1; return a[0] + n; }\n'
        code = 'asm(".thumb_func\\n.type other, %function\\nother: {}\\n bx lr");\nextern "C" int other(int);\nextern "C" int root(int n) {{ return other(n) + 1; }}'
        for branch in ["b", "bl", "bge", "bmi", "blt", "ble"]:
            with self.subTest(branch=branch):
                self.assertEqual(self.worst(deep + code.format(f"cmp r0, #0\\n {branch}.w deep" if branch != "bl" else "bl deep"))[1], ["root", "other", "deep"])
        for branch in ["blx r3", "bx r3"]:
            with self.subTest(branch=branch):
                self.refuses(code.format(branch), "through a pointer")

    def test_a_virtual_call_is_refused(self):
        self.refuses('struct A { virtual int f() = 0; };\nextern "C" int root(A& a) { return a.f() + 1; }', "through a pointer")

    def test_stack_by_a_number_of_run_time_is_refused(self):
        self.refuses(self.leaf + 'extern "C" int root(int n) { return leaf(static_cast<char*>(__builtin_alloca(n))); }', "without a bound")

    def test_a_function_of_unknown_code_is_refused(self):
        self.refuses('extern "C" int elsewhere();\nextern "C" int root() { return elsewhere() + 1; }', "not in the program")

    def test_of_a_library_beside_a_program_only_what_the_program_lacks_counts(self):
        inline = "[[gnu::noinline]] inline int both(volatile char* p) {{ {} }}\n"
        root = 'extern "C" int {}(char* p) {{ return both(p) + 1; }}\n'
        library = self.build("int elsewhere();\n" + inline.format("return elsewhere() + p[0];") + root.format("other"))
        library.rename(self.folder / "library.o")
        (self.folder / "program.ci").rename(self.folder / "library.ci")
        program = self.build(inline.format("return p[0];") + root.format("root")).rename(self.folder / "robot.elf")
        objects = self.folder / "CMakeFiles" / "robot.elf.dir"
        objects.mkdir(parents=True)
        (self.folder / "program.ci").rename(objects / "program.cpp.ci")
        path = stack.CallGraph(self.folder, program, ARM).worst("root")[1]
        self.assertEqual(len(path), 2)

    def test_a_program_that_is_none_is_told_in_one_line(self):
        self.build(self.leaf)
        none = self.folder / "none.elf"
        none.write_text("no program")
        done = subprocess.run([sys.executable, BOARDS / "stack.py", none, "root"], capture_output=True, text=True)
        self.assertRegex(done.stderr, f"^{ARM}objdump .*none.elf: .*\n$")

    def test_binutils_that_are_not_there_are_told_in_one_line(self):
        program = self.build(self.leaf)
        done = subprocess.run([sys.executable, BOARDS / "stack.py", program, "root", "none-"], capture_output=True, text=True)
        self.assertRegex(done.stderr, "^none-objdump: .*; expected .*\n$")

    def test_who_reads_no_more_gets_no_traceback(self):
        program = self.build(self.leaf + 'extern "C" int root(char* p) { return leaf(p) + 1; }')
        script = subprocess.Popen([sys.executable, BOARDS / "stack.py", program, "root"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        script.stdout.close()
        self.assertEqual(script.communicate()[1], b"")
        self.assertEqual(script.returncode, -signal.SIGPIPE)


class Drives(unittest.TestCase):
    def test_a_blank_in_the_name_of_a_build_folder_parts_no_word_of_a_firmware(self):
        board = boards.BOARDS["cortex-m7"]
        line = boards.command(board, Path("/a b/board/cortex-m7/drive.elf"), ["/a b/board/drives/x.drive", "/a b/board/results/x.results"])
        self.assertIn("enable=on,target=native,arg=drive.elf,arg=../drives/x.drive,arg=../results/x.results", line)

    def test_a_build_that_is_not_there_is_told_and_not_begun(self):
        with tempfile.TemporaryDirectory() as folder:
            for script, *words in [["make_drives.py"], ["run_drives.py", "cortex-m7"]]:
                done = subprocess.run([sys.executable, BOARDS / script, folder, *words], capture_output=True, text=True)
                self.assertRegex(done.stderr, f"^{folder}/.*; expected .*\n$")
                self.assertEqual(list(Path(folder).iterdir()), [])


class UndefinedSymbols(Built):
    def refused(self, text):
        return undefined_symbols.refused(undefined_symbols.asked_of_others([self.build(text)], ARM))

    def test_the_heap_is_refused(self):
        self.assertEqual(self.refused("int* f() { return new int[40]; }"), ["_Znaj"])

    def test_a_clock_and_output_are_refused(self):
        text = 'extern "C" int printf(const char*, ...); extern "C" long time(long*);\nint f() { return printf("%d", (int)time(nullptr)); }'
        self.assertEqual(self.refused(text), ["printf", "time"])

    def test_the_libm_of_the_place_is_refused(self):
        self.assertEqual(self.refused('extern "C" float expf(float);\nfloat f(float x) { return expf(x); }'), ["expf"])

    def test_copies_and_the_compilers_arithmetic_are_not(self):
        self.assertEqual(self.refused('extern "C" void* memcpy(void*, const void*, unsigned);\n'
                                      "double f(double a, long long b) { char c[300]; memcpy(c, &a, 300); return a / static_cast<double>(b / c[9]); }"), [])


class Budget(unittest.TestCase):
    def test_a_figure_above_its_budget_is_exceeded_and_one_at_it_is_not(self):
        board = boards.BOARDS["cortex-m7"]
        rows = [("stack", "pipeline", 4097), ("ram", "pipeline", 100), ("", "dem", 90)]
        self.assertEqual(budget.print_table(board, rows, {"stack": {"pipeline": 4096}, "ram": {"pipeline": 100}}, {("stack", "pipeline"): 4000}), 1)

    def test_every_budget_of_the_manual_is_there_and_a_whole_number(self):
        good = {"flash": {"firmware": 1}, "ram": {"pipeline": 1}, "stack": {"pipeline": 1}, "instructions": {"worst": 1, "mean": 1}}
        budget.check(good, "budget.toml")
        for group, names in good.items():
            for name in names:
                for wrong, why in [({}, "is missing"), ({name: "1"}, "is '1'"), ({name: 1.5}, "is 1.5")]:
                    others = {n: 1 for n in names if n != name}
                    with self.assertRaisesRegex(SystemExit, f"^budget.toml: {group}.{name} {why}; expected a whole number$"):
                        budget.check({**good, group: {**others, **wrong}}, "budget.toml")
        with self.assertRaisesRegex(SystemExit, "^budget.toml: flash.firmware is missing"):
            budget.check({}, "budget.toml")
        for wrong, what in [(3, "3"), (True, "True"), ([1], r"\[1\]")]:
            for group in ("flash", "clock"):
                with self.assertRaisesRegex(SystemExit, f"^budget.toml: {group} is {what}; expected a table$"):
                    budget.check({**good, group: wrong}, "budget.toml")

    def test_the_mean_of_simulated_drives_alone_is_not_judged_by_the_budget_of_all(self):
        board = boards.BOARDS["cortex-m7"]
        rows = [("instructions", "worst", 7), ("", "mean", 4)]
        allowed = {"instructions": {"worst": 6, "mean": 3}}
        self.assertEqual(budget.print_table(board, rows, allowed, {}), 2)
        self.assertEqual(budget.print_table(board, rows, budget.without_recorded(allowed), {}), 1)


if __name__ == "__main__":
    unittest.main()
