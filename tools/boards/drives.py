"""The drives that boards are run on: every recorded sweep of ../shared where that is, and simulated scenes."""
import subprocess
import sys
from pathlib import Path

import boards

RECORDED = boards.ROOT.parent / "shared" / "data" / "clausius"
# Streets with the most planes, curbs and work, and a drive whose window moves.
SCENES = {"street": "utm30lx", "steps": "utm30lx", "roundabout": "utm30lx", "inclined_planes": "utm30lx", "city": "utm30lx"}


def folder(build):
    return Path(build) / "board" / "drives"


def all_drives(build):
    return sorted(folder(build).glob("*.drive"))


def check(line):
    done = subprocess.run([str(w) for w in line], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, line))}: {done.stderr.strip()}")


def write(build, robot, scans, can, poses, name):
    """Writes one unless it is newer than what it is made of."""
    out = folder(build) / f"{name}.drive"
    tool = Path(build) / "bin" / "curbline-drive-log"
    sources = [tool, robot, scans, can] + ([poses] if poses else [])
    if out.exists() and all(out.stat().st_mtime > s.stat().st_mtime for s in sources):
        return
    check([tool, "write", "--robot", robot, "--scans", scans, "--can", can, *(["--poses", poses] if poses else []), "--out", out])


def make(build):
    """Makes what is missing. Says so where the recordings are."""
    folder(build).mkdir(parents=True, exist_ok=True)
    robots = boards.ROOT / "tools" / "robots"
    if not RECORDED.is_dir():
        print(f"{RECORDED}: not there; simulated drives alone are run, RECORDED ONES ARE SKIPPED", file=sys.stderr)
    for scans in sorted(RECORDED.glob("*.carmen")):
        write(build, robots / "clausius.toml", scans, scans.with_suffix(".candump"), None, scans.stem)
    for scene, robot in SCENES.items():
        logs = folder(build) / scene
        program, scans = Path(build) / "bin" / "curbline", logs / "scans.carmen"
        if not scans.exists() or scans.stat().st_mtime < program.stat().st_mtime:
            check([program, "simulate", "--scene", scene, "--robot", robots / f"{robot}.toml", "--out", logs])
        poses = logs / "poses.tum"
        write(build, robots / f"{robot}.toml", scans, logs / "can.log", poses if poses.exists() else None, scene)
