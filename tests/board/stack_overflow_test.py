#!/usr/bin/env python3
"""stack_overflow_test.py BUILD: an overflow of the stack ends a firmware in leave(), where a robot's port stops, and not in a lockup."""
import subprocess
import sys
from pathlib import Path

board = Path(sys.argv[1]) / "board" / "cortex-m4f"
subprocess.run(["cmake", "--build", board, "--target", "stack_overflow.elf"], check=True)
qemu = ["qemu-system-arm", "-M", "netduinoplus2", "-display", "none", "-semihosting", "-kernel", board / "stack_overflow.elf"]
done = subprocess.run(qemu, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
said = done.stdout + done.stderr
if done.returncode != 3 or "unexpected exception" not in said:
    sys.exit(f"ended with {done.returncode}; expected 3, of an unexpected exception:\n{said}")
