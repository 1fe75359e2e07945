#!/usr/bin/env python3
"""golden.py BUILD [--keep]: compares the desk's results of the drives, every curb and counter, with those on record in tests/replay/golden.csv.

A change of the algorithm is meant to change some results, a change of the code's form none: the record shows which of the two a commit is. --keep
runs the desk and rewrites the record with its results. The drives are those of tools/boards/drives.py. Where the recorded drives are absent, a
message says so, and their results are neither compared nor rewritten.
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


def on_record():
    with open(RECORD, newline="") as file:
        return {row["drive"]: row["sha256"] for row in csv.DictReader(file)}


def keep(rows):
    with open(RECORD, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([("drive", "sha256"), *sorted(rows.items())])


def main(build, keeps):
    if keeps:
        run_drives.main(build, boards.REFERENCE)
    found, record = results_of(build), on_record()
    absent = sorted(set(record) - set(found))
    if absent:
        print(f"{'KEPT AS THEY WERE' if keeps else 'NOT COMPARED'}, as they are not there: {' '.join(absent)}")
    changed = sorted(name for name in found if record.get(name) != found[name])
    if changed and not keeps:
        sys.exit(f"results of {len(changed)} of {len(found)} drives are not those on record: {' '.join(changed)}\n"
                 f"where that is meant: tests/replay/golden.py {build} --keep")
    if keeps:
        keep(record | found)
        print(f"{len(changed)} of {len(found)} drives changed")
    else:
        print(f"{len(found)} drives, the results on record")


if __name__ == "__main__":
    words = [w for w in sys.argv[1:] if w != "--keep"]
    if len(words) != 1:
        sys.exit(__doc__)
    main(words[0], "--keep" in sys.argv)
