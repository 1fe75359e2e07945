#!/usr/bin/env python3
"""golden.py BUILD [--keep]: are the desk's results of the drives, every curb and counter, those on record in tests/replay/golden.csv?

A change of the algorithm is meant to change some, a change of its form none: the record tells which of both a commit is. --keep writes it anew.
The drives are those of tools/boards/drives.py; where the recorded ones are absent theirs are not compared, and that is said.
"""
import csv
import hashlib
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RECORD = ROOT / "tests" / "replay" / "golden.csv"
sys.dont_write_bytecode = True
sys.path.append(str(ROOT / "tools" / "boards"))
import boards
import drives
import run_drives


def results_of(build):
    folder = run_drives.results_folder(build, boards.REFERENCE)
    return {drive.stem: hashlib.sha256((folder / f"{drive.stem}.results").read_bytes()).hexdigest()
            for drive in drives.all_drives(build)}


def keep(found):
    if not drives.RECORDED.is_dir():
        sys.exit(f"--keep: {RECORD} holds results of all drives, and the recorded ones are not there")
    with open(RECORD, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([("drive", "sha256"), *sorted(found.items())])


def main(build, keeps):
    found = results_of(build)
    if keeps:
        keep(found)
    with open(RECORD, newline="") as file:
        record = {row["drive"]: row["sha256"] for row in csv.DictReader(file)}
    changed = sorted(name for name in found if record.get(name) != found[name])
    absent = sorted(set(record) - set(found))
    if absent:
        print(f"NOT COMPARED, as they are not there: {' '.join(absent)}")
    if changed:
        sys.exit(f"results of {len(changed)} of {len(found)} drives are not those on record: {' '.join(changed)}\n"
                 f"where that is meant: tests/replay/golden.py {build} --keep")
    print(f"{len(found)} drives, the results on record")


if __name__ == "__main__":
    words = [w for w in sys.argv[1:] if w != "--keep"]
    if len(words) != 1:
        sys.exit(__doc__)
    main(words[0], "--keep" in sys.argv)
