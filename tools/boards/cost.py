#!/usr/bin/env python3
"""cost.py BUILD ELF DRIVE... [--budget FILE]: what a firmware of your own sizes costs: flash, memory, stack, and the instructions of a scan
line over your own drives, which are those of `curbline-drive-log write`.

ELF is a drive.elf for the emulated Cortex-M7, built from board/mps2_an500 with -DCURBLINE_ROBOT=FOLDER; BUILD is the build tree of the
repository, for its count_plugin.so. Results and counts go to the folder cost beside ELF. FILE is a budget.toml as those of the boards; the exit
status is 1 if it is exceeded."""
import sys
from pathlib import Path

import boards
import budget
import run_drives

BOARD = boards.BOARDS["cortex-m7"]


def cost_of(build, elf, drives):
    """The rows of tools/budget."""
    results = elf.parent / "cost"
    results.mkdir(exist_ok=True)
    for old in results.iterdir():
        old.unlink()
    for drive in drives:
        run_drives.run_core(BOARD, build, elf, drive.resolve(), results / f"{drive.stem}.results")
    return budget.measure(BOARD, elf, results)


def main(build, elf, drives, allowed):
    plugin = build / "board" / "count_plugin.so"
    for path in (elf, plugin, *drives):
        if not path.is_file():
            sys.exit(f"{path}: not there; expected a file" + (", of cmake --build BUILD --target boards" if path == plugin else ""))
    limits = budget.read_budget(allowed) if allowed else {}
    return 1 if budget.print_table(BOARD, cost_of(build, elf.resolve(), drives), limits, {}) else 0


if __name__ == "__main__":
    words = sys.argv[1:]
    allowed = Path(words[-1]) if len(words) > 2 and words[-2] == "--budget" else None
    paths = [Path(w) for w in (words[:-2] if allowed else words)]
    if len(paths) < 3 or any(w.startswith("-") for w in map(str, paths)):
        sys.exit(__doc__)
    sys.exit(main(paths[0], paths[1], paths[2:], allowed))
