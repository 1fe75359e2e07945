"""The boards and how each is run: on this machine, under qemu-user, or in an emulated board."""
import os
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # `tools/boards/stack.py ... | head` ends without a traceback

ROOT = Path(__file__).resolve().parents[2]
QUIET = ["-display", "none", "-monitor", "none", "-serial", "null"]


@dataclass(frozen=True)
class Board:
    name: str
    folder: str = "desk"   # in board/
    run: tuple = ()        # placed before the program: an emulator and its machine
    compilers: str = ""    # prefix of its binutils
    budget: bool = False   # its folder's budget.toml applies to this core

    @property
    def core(self):
        """A core without an operating system: fed by semihosting."""
        return self.folder != "desk"


def has_avx2():
    flags = Path("/proc/cpuinfo").read_text().split()
    return "avx2" in flags and "fma" in flags


AVX2 = () if has_avx2() else ("qemu-x86_64", "-cpu", "max")
ZCU102 = ("qemu-system-aarch64", "-M", "xlnx-zcu102,canbus0=wire,canbus1=wire", "-object", "can-bus,id=wire",
          "-smp", "6", "-m", "256M")  # both CAN controllers on one wire
ARM = "arm-none-eabi-"
BOARDS = {b.name: b for b in [
    Board("x86-64-gcc"),
    Board("x86-64-gcc-avx2", run=AVX2),
    Board("x86-64-gcc-scalar"),
    Board("x86-64-clang"),
    Board("x86-64-clang-avx2", run=AVX2),
    Board("x86-64-clang-scalar"),
    Board("aarch64-linux", run=("qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"), compilers="aarch64-linux-gnu-"),
    Board("armv7-linux", run=("qemu-arm", "-L", "/usr/arm-linux-gnueabihf"), compilers="arm-linux-gnueabihf-"),
    Board("cortex-m7", "mps2_an500", ("qemu-system-arm", "-M", "mps2-an500"), ARM, budget=True),
    Board("cortex-m7-sp", "mps2_an500", ("qemu-system-arm", "-M", "mps2-an500"), ARM),
    Board("cortex-m4f", "mps2_an500", ("qemu-system-arm", "-M", "mps2-an386"), ARM),
    Board("cortex-r5f", "zcu102_r5", ZCU102, ARM, budget=True),
]}
REFERENCE = "x86-64-gcc"
# The time of an emulated board is derived from its instructions, 16 ns each: the same in every run, however busy this
# machine is.
BY_INSTRUCTIONS = ["-icount", "shift=4,sleep=off"]


def command(board, program, words, extra=()):
    """The command line that runs a board's program with these words: of a core, files, from its own folder, since a blank in a word parts it."""
    if not board.core:
        return [*board.run, str(program), *words]
    arguments = "".join(f",arg={w}" for w in (program.name, *(os.path.relpath(w, program.parent) for w in words)))
    line = [*board.run, *QUIET, "-semihosting-config", "enable=on,target=native" + arguments, *extra]
    if board.folder == "zcu102_r5":
        return [*line, "-device", f"loader,file={program}", "-device", f"loader,file={program.parent / 'wake_r5.elf'},cpu-num=0"]
    return [*line, "-kernel", str(program)]


def run(board, program, words, extra=(), timeout_s=900):
    """Runs it and returns its output. Ends with one line if it fails."""
    line = command(board, program, words, extra)
    environment = {**os.environ, "QEMU_AUDIO_DRV": "none"}
    try:
        done = subprocess.run(line, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=timeout_s, env=environment,
                              cwd=program.parent if board.core else None)
    except FileNotFoundError:
        sys.exit(f"{line[0]}: not found; expected Debian's package, which tools/setup installs")
    except subprocess.TimeoutExpired:
        sys.exit(f"{board.name}: {program.name} has not ended after {timeout_s} s")
    if done.returncode != 0:
        sys.exit(f"{board.name}: {' '.join([program.name, *words])} ended with {done.returncode}: {'; '.join(done.stderr.splitlines())}")
    said = (done.stdout + done.stderr).splitlines(keepends=True)
    return "".join(line for line in said if not line.startswith("qemu: module audio"))  # QEMU lacks an audio module


def program_of(build, name, program="drive.elf"):
    return Path(build) / "board" / name / program
