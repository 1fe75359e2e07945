"""Which instruction of a firmware belongs to which stage of the pipeline, by its debug information, inlined code included."""
import os
import re
import subprocess
from pathlib import Path

from boards import ROOT

# Stage 0 is what is not the pipeline: the board, its port, the drive's records.
STAGES = ["outside", "tilt", "pipeline", "points", "cells", "regions", "planes", "labels", "curbs"]
HELPER = -1
# Files of lib/ whose code is written for one stage; that of others belongs to the stage that calls it.
FILES = {name: stage for stage, names in {
    "tilt": "frame.hpp signal.cpp tilt_decoder.cpp tilt_decoder.hpp",
    "pipeline": "pipeline.hpp",
    "points": "line_intake.hpp line_projection.hpp map_comparison.hpp pose_offset.cpp pose_offset.hpp pose_track.cpp "
              "pose_track.hpp sweep_turns.hpp tilt_latency.cpp tilt_latency.hpp tilt_snapshot.hpp tilt_track.hpp",
    "cells": "viewpoints.hpp",
    "regions": "gain_heap.hpp region_graph.hpp segmentation.cpp segmentation.hpp",
    "planes": "clean_fit.hpp common_noise.cpp common_noise.hpp ground.hpp index_set.hpp obstacles.hpp plane_mixture.hpp "
              "region_ranking.hpp run.hpp strip_tally.hpp",
    "labels": "label_field.hpp label_site.hpp planes_near_by.hpp",
    "curbs": "border_finder.hpp borders.hpp cell_line.hpp curb.cpp curb.hpp curb_maker.hpp curb_piece.hpp "
             "curb_stages.hpp curb_tracer.hpp ground_end.hpp line_fit.cpp line_fit.hpp plane_gap.cpp plane_gap.hpp shadow.cpp shadow.hpp "
             "step_height.hpp",
}.items() for name in names.split()}


def run(line, text=None):
    """Standard output of a command that must succeed."""
    return subprocess.run([str(word) for word in line], input=text, capture_output=True, text=True, check=True).stdout


def stage_of_frame(function, path):
    """Stage of one frame of an inline stack, None for what any stage uses."""
    name = Path(path).name
    if name in ("dem.hpp", "cell.hpp"):  # stages read cells too; adding to them is a stage
        return "cells" if re.search(r"\b(add|follow|clear_touched)\b", function) else None
    if name == "tilt_track.hpp" and re.search(r"\bpush\b", function):
        return "tilt"
    if name in FILES:
        return FILES[name]
    return "outside" if ROOT / "board" in Path(path).parents or ROOT / "port" in Path(path).parents else None


def stage_of_stack(frames):
    """frames: (function, file), innermost first. What the pipeline called last decides; what that called in turn is part of it."""
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
    """[(address, size, type, demangled name)] of what has a size."""
    out = run([nm, "-S", "-C", elf])
    found = re.findall(r"^([0-9a-f]+) ([0-9a-f]+) (\w) (.*)$", out, re.M)
    return [(int(a, 16), int(s, 16), t, n) for a, s, t, n in found]


def write_map(elf, path, prefix):
    """The count plugin's map of a firmware."""
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
