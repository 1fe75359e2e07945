#!/usr/bin/env python3
"""template_test.py BUILD PROGRAM: board/_template's main loop, unchanged, on a port that feeds it a drive, informs the motors after each
scan line of the same curbs as the desk's own run of that drive: their number, and the height of the one ahead, of a robot that stands and of
one that drives. While the servo is silent for a second, each line is dropped and the counter does not advance; nor does it while the laser is
covered, though the lines are taken, nor with a curb ahead that the bus does not take. An encoder that is stuck is told as a tilt that rests.
Poses that the pipeline refuses change nothing."""
import math
import os
import struct
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools" / "boards"))
import boards  # noqa: E402
import drives  # noqa: E402
import run_bus  # noqa: E402
import run_drives  # noqa: E402

CURB = struct.Struct("<9f4H")
COUNTERS = 4 * (Path(__file__).resolve().parents[2] / "lib/curbline/counters.hpp").read_text().count("std::uint32_t")
AHEAD, STATUS, OK, STALE, RESTING = 0x6A0, 0x6A1, 1, 2, 3  # from lib/curbline/can/curb_frames.hpp
HALF_WIDTH, NOD_PERIOD_NS = 0.5, 4e9  # from template_robot/robot.hpp
FRAME_ID, FRAME_DATA = 8 + 8, 8 + 8 + 4 + 6  # offsets in the record of a frame
POSE, SCAN_LINE, RANGES = 3, 4, 8 + 8  # RecordKinds of port/drive_log; the offset in the record of a line
ORIGIN = (0.0, 0.0, 0.0)  # x, y and heading of a robot that stands


def ahead_at(x0, y0, x1, y1):
    """x of the nearest point of a segment within the path of a robot at the origin, or None."""
    low, high = 0.0, 1.0
    for at_first, at_last in [(x0, x1), (HALF_WIDTH - y0, HALF_WIDTH - y1), (HALF_WIDTH + y0, HALF_WIDTH + y1)]:
        if at_first < 0 and at_last < 0:
            return None
        crossing = at_first / (at_first - at_last) if (at_first < 0) != (at_last < 0) else None
        if at_first < 0:
            low = max(low, crossing)
        if at_last < 0:
            high = min(high, crossing)
    return min(x0 + low * (x1 - x0), x0 + high * (x1 - x0)) if low <= high else None


def poses_at_lines(drive):
    """x, y and heading of the newest pose at each scan line."""
    pose = ORIGIN
    for kind, record in run_bus.records(drive):
        if kind == POSE:
            _, x, y, _, qx, qy, qz, qw = struct.unpack_from("<q7f", record, 8)
            pose = x, y, math.atan2(2 * (qx * qy + qz * qw), 1 - 2 * (qy * qy + qz * qz))
        if kind == SCAN_LINE:
            yield pose


def in_base(x, y, pose):
    dx, dy, cos, sin = x - pose[0], y - pose[1], math.cos(pose[2]), math.sin(pose[2])
    return cos * dx + sin * dy, cos * dy - sin * dx


def told_by_results(path, drive):
    """(curbs, height of the nearest ahead in mm or None) after each line of a laser that sees: see lib/curbline/intake/sight_watch.hpp."""
    before, seen_ns = (0, 0, 0), None
    for (_, record), pose in zip(run_bus.records(path), poses_at_lines(drive)):
        time_ns, _, *counted = struct.unpack_from("<qI3I", record, 8)  # lines, points, outside
        taken, inside, outside = (now != then for now, then in zip(counted, before))
        before, seen_ns = counted, time_ns if inside else seen_ns
        sees = taken and (inside or outside) and seen_ns is not None and time_ns - seen_ns <= NOD_PERIOD_NS
        count_at = 20 + COUNTERS
        count, = struct.unpack_from("<I", record, count_at)
        on_the_way = []
        for k in range(count):
            x0, y0, x1, y1, height, *_ = CURB.unpack_from(record, count_at + 4 + CURB.size * k)
            at = ahead_at(*in_base(x0, y0, pose), *in_base(x1, y1, pose))
            if at is not None:
                on_the_way.append((height == 0.0, at, height))  # steps come before creases
        if sees:
            ahead = min(on_the_way, default=None)
            yield count, None if ahead is None else ahead[2] * 1000


def lines_told(path):
    """(AHEAD or None, STATUS) after each scan line, from the frames that the robot sent."""
    ahead = None
    for _, record in run_bus.records(path):
        frame_id, data = struct.unpack_from("<I", record, FRAME_ID)[0], record[FRAME_DATA:]
        if frame_id == AHEAD:
            assert ahead is None
            ahead = data
        else:
            assert frame_id == STATUS
            yield ahead, data
            ahead = None


def told_by_frames(path):
    """The same as told_by_results(), from the frames that the robot sent."""
    for ahead, status in lines_told(path):
        if ahead is not None:
            yield status[2], struct.unpack_from("<h", ahead, 4)[0] if ahead[7] & 3 else None


def run(program, drive, sent, **more):
    subprocess.run([program], env={**os.environ, "CURBLINE_DRIVE": str(drive), "CURBLINE_SENT": str(sent), **more}, check=True)


def change(drive, out, changed, end_ns=2e9):
    """Writes the drive with the records from 1 s to 2 s, or to end_ns, changed: changed(kind, record)."""
    start_ns = next(run_bus.frame_time(record) for kind, record in run_bus.records(drive) if kind == run_bus.CAN_FRAME)
    with out.open("wb") as file:
        for kind, record in run_bus.records(drive):
            timed = kind in (run_bus.CAN_FRAME, SCAN_LINE)
            file.write(changed(kind, record) if timed and 1e9 < run_bus.frame_time(record) - start_ns < end_ns else record)


def silent(kind, record):
    return b"" if kind == run_bus.CAN_FRAME else record


def covered(kind, record):
    return record[:RANGES] + bytes(len(record) - RANGES) if kind == SCAN_LINE else record


def stuck_at_first():
    """An encoder that repeats the angle of the first frame that is changed."""
    data = []

    def stuck(kind, record):
        if kind != run_bus.CAN_FRAME:
            return record
        data[:] = data or [record[FRAME_DATA:]]
        return record[:FRAME_DATA] + data[0]
    return stuck


def told_in(sent):
    """(AHEAD or None, STATUS) of what was sent. A line that sees nothing is reported too, by a counter that does not advance; another one by an
    AHEAD and a counter that is one higher."""
    told = list(lines_told(sent))
    for line, ((_, before), (ahead, status)) in enumerate(zip(told, told[1:]), 1):
        if status[0] != (before[0] + (ahead is not None)) % 256:
            sys.exit(f"line {line}: the counter goes from {before[0]} to {status[0]} with{'out' if ahead is None else ''} a curb ahead")
    return told


def told_of(program, drive, folder, changed, end_ns=2e9):
    """told_in() of the changed drive."""
    other, sent = folder / f"{changed.__name__}.drive", folder / f"{changed.__name__}.sent"
    change(drive, other, changed, end_ns)
    run(program, other, sent)
    return told_in(sent)


def check_full_bus(program, drive, folder):
    counts = []
    for name, more in [("free", {}), ("full", {"CURBLINE_FULL_BUS": "1"})]:
        run(program, drive, folder / f"{name}_bus.sent", **more)
        counts.append(sum(ahead is not None for ahead, _ in told_in(folder / f"{name}_bus.sent")))
    if counts[0] < 100 or counts[1] != counts[0] - counts[0] // 3:
        sys.exit(f"of {counts[0]} curbs ahead {counts[1]} are sent over a bus that takes two of three")
    print(f"{counts[0] - counts[1]} curbs ahead that the bus did not take")


def check_refused_poses(program, drive, folder):
    """Each pose is followed by one of a second before it, elsewhere and on its back, as by a quaternion with qw first."""
    other, refused = folder / "refused_poses.drive", 0
    with other.open("wb") as file:
        for kind, record in run_bus.records(drive):
            file.write(record)
            if kind == POSE:
                time_ns, x, y, z, *_ = struct.unpack_from("<q7f", record, 8)
                bad = bytearray(record)
                struct.pack_into("<q7f", bad, 8, time_ns - 1_000_000_000, x + 3, y, z, 1, 0, 0, 0)
                file.write(bad)
                refused += 1
    run(program, drive, folder / "poses.sent")
    run(program, other, folder / "refused_poses.sent")
    if refused < 100 or (folder / "poses.sent").read_bytes() != (folder / "refused_poses.sent").read_bytes():
        sys.exit(f"{drive.stem}: {refused} poses that the pipeline refuses change what the template's loop tells")
    print(f"{refused} refused poses change nothing")


def check_silence(program, drive, folder):
    told = told_of(program, drive, folder, silent)
    dropped = [status[1] & 3 for ahead, status in told if ahead is None]
    if len(dropped) < 20 or STALE not in dropped or told[-1][0] is None:
        sys.exit(f"a servo that is silent for a second: {len(dropped)} lines are told as dropped, their tilt as {sorted(set(dropped))}")
    print(f"{len(dropped)} lines dropped while the servo was silent")


def check_cover(program, drive, folder):
    told = told_of(program, drive, folder, covered)
    tilts = [status[1] & 3 for ahead, status in told if ahead is None]
    if len(tilts) < 35 or OK not in tilts or told[-1][0] is None:
        sys.exit(f"a laser that is covered for a second: {len(tilts)} lines of 40 are told as seeing nothing, their tilt as {sorted(set(tilts))}")
    print(f"{len(tilts)} lines saw nothing while the laser was covered")


def check_rest(program, drive, folder):
    """From a sweep there and back after the encoder is stuck until it moves again, and at no other time."""
    told = told_of(program, drive, folder, stuck_at_first(), 1e9 + NOD_PERIOD_NS + 1e9)
    tilts = [status[1] & 3 for _, status in told]
    runs = [tilt for tilt, before in zip(tilts, [None, *tilts]) if tilt != before]
    if runs != [OK, RESTING, OK] or not 35 <= tilts.count(RESTING) <= 45:
        sys.exit(f"an encoder that is stuck for a second more than a sweep there and back: the tilt is told as {runs}, of {tilts.count(RESTING)} "
                 f"lines as resting; expected {[OK, RESTING, OK]}, about 40")
    print(f"{tilts.count(RESTING)} lines with a tilt that rests while the encoder was stuck")


def check_curbs(build, program, drive, folder):
    sent = folder / f"{drive.stem}.sent"
    run(program, drive, sent)
    counter = next(status[0] for ahead, status in lines_told(sent) if ahead is not None)
    if counter != 0:
        sys.exit(f"{drive.stem}: the first curb ahead has the counter {counter}, and not 0, which follows the 255 of before")
    tilts = {status[1] & 3 for _, status in lines_told(sent)}
    if tilts != {OK}:
        sys.exit(f"{drive.stem}: the tilt is told as {sorted(tilts)}; expected {OK} after every line")
    ours = list(told_by_frames(sent))
    theirs = list(told_by_results(run_drives.results_folder(build, boards.REFERENCE) / f"{drive.stem}.results", drive))
    for line, (a, b) in enumerate(zip(ours, theirs)):
        if a[0] != b[0] or (a[1] is None) != (b[1] is None) or (a[1] is not None and abs(a[1] - b[1]) > 1):
            sys.exit(f"{drive.stem}, line {line}: the template's loop tells {a}, and the desk has {b}")
    if len(ours) != len(theirs) or not any(height for _, height in ours):
        sys.exit(f"{drive.stem}: the template's loop told of {len(ours)} lines, and the desk of {len(theirs)}, or never of a curb")
    print(f"{drive.stem}: {len(ours)} lines, {sum(height is not None for _, height in ours)} of them with a curb ahead")


def main(build, program):
    folder = run_drives.results_folder(build, "template")
    folder.mkdir(parents=True, exist_ok=True)
    steps = drives.folder(build) / "steps.drive"  # they lie across the robot's way
    check_silence(program, steps, folder)
    check_cover(program, steps, folder)
    check_full_bus(program, steps, folder)
    check_curbs(build, program, steps, folder)
    drive = drives.folder(build) / "random-drive-9001.drive"  # longer than a sweep there and back
    check_rest(program, drive, folder)
    check_refused_poses(program, drive, folder)
    check_curbs(build, program, drive, folder)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
