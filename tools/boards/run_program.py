#!/usr/bin/env python3
"""run_program.py BUILD BOARD PROGRAM [word...]: runs a firmware on its board and prints its output. Fails if the firmware fails."""
import sys

import boards

if __name__ == "__main__":
    if len(sys.argv) < 4 or sys.argv[2] not in boards.BOARDS:
        sys.exit(__doc__)
    build, name, program, *words = sys.argv[1:]
    print(boards.run(boards.BOARDS[name], boards.program_of(build, name, program).resolve(), words, boards.BY_INSTRUCTIONS, timeout_s=300), end="")
