#!/usr/bin/env python3
"""run_drives.py BUILD BOARD: runs every drive on a board and compares its results with the desk's, byte for byte.

Results go to BUILD/board/results/BOARD. The others are compared with the desk's own board, x86-64-gcc, so run that first. A core also
writes the stack that it used (NAME.stack), and one with a budget its instruction counts (NAME.counts, a row a scan line).
"""
import re
import sys
from pathlib import Path

import boards
import drives
import stages


def results_folder(build, name):
    return Path(build) / "board" / "results" / name


def run_core(board, build, program, drive, results):
    """Runs with the counting plugin if the board has a budget."""
    extra = counting(board, build, program, results) if board.budget else []
    said = boards.run(board, program, [str(drive), str(results)], extra)
    used = re.search(r"stack bytes used: (\d+)", said)
    if not used:
        sys.exit(f"{board.name}: {drive.name}: no line of the stack's use in: {said.strip()}")
    results.with_suffix(".stack").write_text(used[1])


def counting(board, build, program, results):
    map_file = results.parent / "stages.map"
    newest_source = max(path.stat().st_mtime for path in (program, Path(stages.__file__)))
    if not map_file.exists() or map_file.stat().st_mtime < newest_source:
        stages.write_map(program, map_file, board.compilers)
    plugin = Path(build).resolve() / "board" / "count_plugin.so"
    return ["-plugin", f"{plugin},map={map_file},out={results.with_suffix('.counts')}"]


def first_difference(a, b):
    return next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))


def main(build, name):
    board = boards.BOARDS[name]
    program = boards.program_of(build, name).resolve()
    folder = results_folder(build, name).resolve()
    all_drives = drives.all_drives(build)
    if not all_drives:
        sys.exit(f"{drives.folder(build)}: no drive; expected those of tools/boards/make_drives.py")
    folder.mkdir(parents=True, exist_ok=True)
    for drive in all_drives:
        results = folder / f"{drive.stem}.results"
        if board.core:
            run_core(board, build, program, drive.resolve(), results)
        else:
            boards.run(board, program, [str(drive), str(results)])
        if name == boards.REFERENCE:
            continue
        ours, theirs = results.read_bytes(), (results_folder(build, boards.REFERENCE) / results.name).read_bytes()
        if ours != theirs:
            sys.exit(f"{name}: {drive.stem}: results differ from the desk's from byte {first_difference(ours, theirs)} on "
                     f"({len(ours)} and {len(theirs)} bytes)")
    print(f"{name}: {len(all_drives)} drives, the same bytes")


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[2] not in boards.BOARDS:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
