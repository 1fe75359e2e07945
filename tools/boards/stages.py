"""Assigns the instructions of a firmware to the stages of the pipeline, from its debug information, inlined code included."""
import os
import re
import subprocess
from pathlib import Path

from boards import ROOT

# Stage 0 is everything outside the pipeline: the board, its port, the drive's records.
STAGES = ["outside", "tilt", "pipeline", "points", "cells", "regions", "planes", "labels", "curbs"]
HELPER = -1
# Folders of lib/curbline whose code is written for one stage. Other code, the shared parts and the map, belongs to the stage that calls
# it.
FOLDERS = {"can": "tilt", "intake": "points", "regions": "regions", "planes": "planes", "labels": "labels", "borders": "curbs",
           "curbs": "curbs"}


def run(line, text=None):
    """Standard output of a command. Ends with one line if it fails."""
    words = [str(word) for word in line]
    try:
        done = subprocess.run(words, input=text, capture_output=True, text=True)
    except OSError as error:
        raise SystemExit(f"{words[0]}: {error.strerror}; expected a program") from None
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(words)}: {' '.join(done.stderr.split())}")
    return done.stdout


def stage_of_frame(function, path):
    """Stage of one frame of an inline stack, None for code that any stage uses."""
    path = Path(path)
    if path.parent.name == "map":  # all stages read cells; adding to them is a stage of its own
        return "cells" if path.name == "laser_way.hpp" or re.search(r"\b(add|follow|clear_touched)\b", function) else None
    if path.name == "pipeline.hpp":
        return "pipeline"
    if path.name == "tilt_track.hpp" and re.search(r"\bpush\b", function):
        return "tilt"
    if path.parent.name in FOLDERS:
        return FOLDERS[path.parent.name]
    return "outside" if ROOT / "board" in path.parents or ROOT / "port" in path.parents else None


def stage_of_stack(frames):
    """frames: (function, file), innermost first. The function that the pipeline called decides; what that called in turn is part of it."""
    stage = None
    for function, path in frames:
        here = stage_of_frame(function, path)
        if here in ("outside", "pipeline"):
            return stage or here
        if here is not None:
            stage = here
    return stage


def inline_stacks(elf, addresses, addr2line):
    """{address: [(function, file), ...]}, innermost first."""
    listing = run([addr2line, "-a", "-f", "-C", "-i", "-e", elf], "\n".join(hex(a) for a in addresses)).splitlines()
    stacks, frames = {}, None
    lines = iter(listing)
    for line in lines:
        if re.fullmatch(r"0x[0-9a-f]+", line):
            frames = stacks.setdefault(int(line, 16), [])
        else:
            frames.append((line, os.path.normpath(next(lines).rsplit(":", 1)[0])))
    return stacks


def symbols(elf, nm):
    """[(address, size, type, demangled name)] of symbols that have a size."""
    out = run([nm, "-S", "-C", elf])
    found = re.findall(r"^([0-9a-f]+) ([0-9a-f]+) (\w) (.*)$", out, re.M)
    return [(int(a, 16), int(s, 16), t, n) for a, s, t, n in found]


def write_map(elf, path, prefix):
    """Writes the count plugin's map of a firmware."""
    functions = [(a & ~1, s, n) for a, s, t, n in symbols(elf, prefix + "nm") if t.lower() in "tw"]
    line_end = [a for a, _, n in functions if re.search(r"\bDrive<.*::end_line\(", n)]
    if len(line_end) != 1:
        raise SystemExit(f"{elf}: {len(line_end)} functions Drive::end_line; expected one")
    addresses = sorted({a for begin, size, _ in functions for a in range(begin, begin + size, 2)})
    stacks = inline_stacks(elf, addresses, prefix + "addr2line")
    ranges = []
    for address in addresses:
        stage = stage_of_stack(stacks[address])
        number = HELPER if stage is None else STAGES.index(stage)
        if ranges and ranges[-1][1] == address and ranges[-1][2] == number:
            ranges[-1][1] = address + 2
        else:
            ranges.append([address, address + 2, number])
    Path(path).write_text(f"line {line_end[0]:x}\n" + "".join(f"range {a:x} {b:x} {s}\n" for a, b, s in ranges))
