"""The drives for the boards: every recorded sweep of ../shared, if that exists, and simulated scenes."""
import sys
from pathlib import Path

import boards
import stages

sys.path.append(str(boards.ROOT / "tools"))
import scoring

RECORDED = boards.ROOT.parent / "shared" / "data" / "clausius"
PROGRAMS = ["curbline", "curbline-drive-log"]
# The streets with the most planes, curbs and work, a drive whose window moves, and one whose poses step.
LASER = "utm30lx"
SCENES = ["street", "steps", "roundabout", "inclined_planes", "city", "random-drive:9001"]
ERRORS = {"random-drive:9001": scoring.JUMPS}


def folder(build):
    return Path(build) / "board" / "drives"


def all_drives(build):
    return sorted(folder(build).glob("*.drive"))


def write(build, robot, scans, can, poses, name):
    """Writes a drive unless it is newer than its sources."""
    out = folder(build) / f"{name}.drive"
    tool = Path(build) / "bin" / "curbline-drive-log"
    sources = [tool, robot, scans, can] + ([poses] if poses else [])
    if out.exists() and all(out.stat().st_mtime > s.stat().st_mtime for s in sources):
        return
    stages.run([tool, "write", "--robot", robot, "--scans", scans, "--can", can, *(["--poses", poses] if poses else []), "--out", out])


def make(build):
    """Makes the missing drives. Prints a note if the recordings do not exist."""
    for program in PROGRAMS:
        if not (Path(build) / "bin" / program).exists():
            sys.exit(f"{build}/bin/{program}: not there; expected a build of the host programs")
    folder(build).mkdir(parents=True, exist_ok=True)
    robots = boards.ROOT / "tools" / "robots"
    if not RECORDED.is_dir():
        print(f"{RECORDED}: not there; simulated drives alone are run, RECORDED ONES ARE SKIPPED", file=sys.stderr)
    for scans in sorted(RECORDED.glob("*.carmen")):
        write(build, robots / "clausius.toml", scans, scans.with_suffix(".candump"), None, scans.stem)
    for scene in SCENES:
        name = scene.replace(":", "-")
        logs = folder(build) / name
        logs.mkdir(exist_ok=True)
        program, scans, robot = Path(build) / "bin" / "curbline", logs / "scans.carmen", robots / f"{LASER}.toml"
        if not scans.exists() or scans.stat().st_mtime < program.stat().st_mtime:
            simulated = scoring.late_robot(LASER, logs, ERRORS[scene]) if scene in ERRORS else robot
            stages.run([program, "simulate", "--scene", scene, "--robot", simulated, "--out", logs])
        poses = logs / "poses.tum"
        write(build, robot, scans, logs / "can.log", poses if poses.exists() else None, name)
