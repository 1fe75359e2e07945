#!/usr/bin/env python3
"""run_bus.py BUILD: runs a drive on the Cortex-R5 with its tilt frames sent over its CAN bus, each at its own time; then the same drive on the
desk, with the frames that the board says it received. Every frame must arrive undamaged and within LATEST_NS; curbs and counters must be the
same bytes."""
import struct
import sys

import boards
import drives
import run_drives
import stages

LATEST_NS = 1_000_000
HEADER, FRAME_TIME = struct.Struct("<II"), struct.Struct("<q")
CAN_FRAME, RESULT = 2, 5  # RecordKind of port/drive_log


def records(path):
    """(kind, header and contents) of each record of a stream."""
    data, at = path.read_bytes(), 0
    while at < len(data):
        kind, size = HEADER.unpack_from(data, at)
        yield kind, data[at:at + HEADER.size + size]
        at += HEADER.size + size


def frame_time(record):
    return FRAME_TIME.unpack_from(record, HEADER.size)[0]


def as_received(drive, received, out):
    """Writes the drive with the frames as the board received them. Returns the largest delay."""
    latest = 0
    frames = iter(received)
    with out.open("wb") as file:
        for kind, record in records(drive):
            if kind == CAN_FRAME:
                got = next(frames, None)
                if got is None:
                    sys.exit(f"{drive.name}: {len(received)} frames came, and more were sent")
                start = HEADER.size + FRAME_TIME.size
                if got[:HEADER.size] != record[:HEADER.size] or got[start:] != record[start:]:
                    sys.exit(f"{drive.name}: the frame sent at {frame_time(record)} ns came as another one")
                late = frame_time(got) - frame_time(record)
                if not 0 <= late <= LATEST_NS:
                    sys.exit(f"{drive.name}: the frame sent at {frame_time(record)} ns came {late} ns later; expected 0 to {LATEST_NS}")
                latest, record = max(latest, late), got
            file.write(record)
    if next(frames, None) is not None:
        sys.exit(f"{drive.name}: more frames came than were sent")
    return latest


def check_curbs(build, drive, results):
    """The bus shifts the times of the tilt by a few microseconds: the curbs must equal those from the log to half a centimetre."""
    ours, theirs = ([[float(v) for v in line.split(",")[:5]] for line in curbs_of(build, path)] for path in (results, reference_of(build, drive)))
    if not ours or len(ours) != len(theirs) or any(abs(a - b) > 0.005 for o, t in zip(ours, theirs) for a, b in zip(o, t)):
        sys.exit(f"{drive.stem}: curbs over the bus are {ours}, and those of the log {theirs}")


def curbs_of(build, results):
    return stages.run([f"{build}/bin/curbline-drive-log", "curbs", results]).splitlines()[1:]


def reference_of(build, drive):
    return run_drives.results_folder(build, boards.REFERENCE) / f"{drive.stem}.results"


def main(build):
    board, desk = boards.BOARDS["cortex-r5f"], boards.BOARDS[boards.REFERENCE]
    folder = run_drives.results_folder(build, "bus").resolve()
    folder.mkdir(parents=True, exist_ok=True)
    recorded = drives.folder(build) / "scan-03.drive"
    drive = recorded if recorded.exists() else drives.folder(build) / "street.drive"
    board_results, received_drive, desk_results = (folder / f"{drive.stem}.{end}" for end in ("board", "drive", "desk"))
    boards.run(board, boards.program_of(build, board.name, "bus_drive.elf").resolve(), [str(drive.resolve()), str(board_results)], boards.BY_INSTRUCTIONS)
    received = [record for kind, record in records(board_results) if kind == CAN_FRAME]
    latest = as_received(drive, received, received_drive)
    boards.run(desk, boards.program_of(build, desk.name), [str(received_drive), str(desk_results)])
    ours = b"".join(record for kind, record in records(board_results) if kind == RESULT)
    if not ours or ours != desk_results.read_bytes():
        sys.exit(f"{drive.name}: the board's results differ from the desk's of the same frames")
    check_curbs(build, drive, desk_results)
    print(f"{drive.stem}: {len(received)} frames over the bus, {latest} ns late at most; the same bytes as on the desk")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
