#!/usr/bin/env python3
"""undefined_symbols.py BUILD BOARD: the symbols that the optimised library, the pipeline, and the ports that run anywhere (candump, the
scanners' protocols) need from outside. The exit status is 1 if these are more than copying, comparing and searching memory, the square
root and the compiler's arithmetic helpers: no heap, no I/O, no clock, no exceptions, no locks."""
import re
import sys

import boards
import stages

ALLOWED = re.compile("|".join([
    r"mem(cpy|move|set|cmp|chr)|bcmp|__aeabi_mem(cpy|move|set|clr)[48]?",
    r"sqrtf?",
    r"__aeabi_(?!atexit)[a-z0-9]+",  # Arm run-time ABI: integer division, 64-bit and double arithmetic
    r"_GLOBAL_OFFSET_TABLE_",  # position-independent code
]))
ARCHIVES = ("curbline/lib/libcurbline.a", "common/libcurbline_drive.a", "common/libcurbline_protocols.a")


def asked_of_others(archives, prefix):
    """The symbols that the archives together use and do not define."""
    undefined, defined = set(), set()
    for line in stages.run([prefix + "nm", *archives]).splitlines():
        if match := re.fullmatch(r"[0-9a-f ]*\s(\w) (\S+)", line):
            (undefined if match[1] in "Uwv" and not re.match(r"[0-9a-f]", line) else defined).add(match[2])
    return undefined - defined


def refused(symbols):
    return sorted(s for s in symbols if not ALLOWED.fullmatch(s))


def main(build, name):
    board = boards.BOARDS[name]
    archives = [boards.program_of(build, name).parent / archive for archive in ARCHIVES]
    for archive in archives:
        if not archive.exists():
            sys.exit(f"{archive}: not there; expected the build of board {name}")
    asked = asked_of_others(archives, board.compilers)
    foreign = refused(asked)
    print(f"{name}: {', '.join(sorted(asked)) or 'nothing'}")
    if foreign:
        sys.exit(f"{name}: the library asks for {', '.join(foreign)}; expected memcpy and its like, sqrt and the compiler's helpers alone")


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[2] not in boards.BOARDS:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
