#!/usr/bin/env python3
"""budget.py BUILD BOARD [--keep]: what the firmware costs: used, allowed, and the change since the figures were last kept.

BOARD is cortex-m7 or cortex-r5f. The figures are those of its firmware and of its last run over the drives (run_drives.py). The exit status is 1
if a budget of board/FOLDER/budget.toml is exceeded. --keep writes the figures to board/FOLDER/measured.csv. Without the recorded drives the mean of
a line is that of the simulated ones, which require the most work: it is not judged then, and --keep is refused.
"""
import csv
import re
import sys
import tomllib
from pathlib import Path

import boards
import drives
import members
import run_drives
import stack
import stages

BUDGETS = [("flash", "firmware"), ("ram", "pipeline"), ("stack", "pipeline"), ("instructions", "worst"), ("instructions", "mean")]
PAINT_MARGIN = 160  # bytes of the frames above main(), which painting includes and the graph of main() does not


def flash_bytes(elf, prefix):
    """The bytes that the loader writes: every section with contents that is part of the image."""
    out = stages.run([prefix + "objdump", "-h", elf])
    sections = re.findall(r"^\s*\d+ (\S+)\s+([0-9a-f]+) .*\n\s+(.*)$", out, re.M)
    return sum(int(size, 16) for _, size, flags in sections if "LOAD" in flags.split(", "))


def stack_rows(board, elf, results):
    """The pipeline's by the call graph; main()'s by the graph and by painting, which must agree."""
    graph = stack.CallGraph(elf.parent, elf, board.compilers)
    pipeline, _ = graph.worst("::take(const curbline::ScanLine&)")
    main, path = graph.worst("main")
    painted = max(int(p.read_text()) for p in results.glob("*.stack"))
    if painted > main + PAINT_MARGIN:
        deepest = " > ".join(short(graph.names.get(n, n)) for n in path)
        sys.exit(f"{board.name}: {painted} bytes of stack are painted over, and the call graph allows {main} ({deepest}); its walk is wrong")
    return [("stack", "pipeline", pipeline), ("", "main(), by the call graph", main), ("", "main(), by painting", painted)]


def short(name):
    """A function's own name and class, without namespaces, arguments and templates."""
    name = name.split(" [with")[0]
    while (plain := re.sub(r"<[^<>]*>", "", name)) != name:
        name = plain
    return "::".join(name.split("(")[0].split(" ")[-1].split("::")[-2:])


def read_counts(path):
    """A row of counts by stage for each scan line of a drive."""
    with path.open() as file:
        return [[int(n) for n in row] for row in csv.reader(file)]


def rows_by_drive(results):
    """The drives with the worst line and the highest mean."""
    totals = {path.stem: [sum(line[1:len(stages.STAGES)]) for line in read_counts(path)] for path in results.glob("*.counts")}
    means = {drive: sum(t) // len(t) for drive, t in totals.items()}
    recorded = [n for drive, t in totals.items() if drive.startswith("scan-") for n in t]
    rows = [("", f"mean of {max(means, key=means.get)}, the highest", max(means.values()))]
    if recorded:
        rows += [("", "recorded drives alone: worst", max(recorded)), ("", "recorded drives alone: mean", sum(recorded) // len(recorded))]
    return rows


def instruction_rows(results):
    """Worst and mean of a line, and of each stage, over all drives."""
    lines = [line for path in sorted(results.glob("*.counts")) for line in read_counts(path)]
    if not lines:
        sys.exit(f"{results}: no counts; run tools/boards/run_drives.py first")
    count = len(stages.STAGES)
    totals = [sum(line[1:count]) for line in lines]
    worst, mean = max(totals), sum(totals) // len(totals)
    rows = [("instructions", "worst", worst), ("", "mean", mean), *rows_by_drive(results)]
    at_worst = lines[totals.index(worst)]
    for s, stage in enumerate(stages.STAGES[1:], 1):
        rows.append(("", f"{stage}: mean", sum(line[s] for line in lines) // len(lines)))
        rows.append(("", f"{stage}: in the worst line", at_worst[s]))
    return rows


def measure(board, elf, results):
    parts = []
    for name, size in members.member_sizes(elf, "Pipeline<", board.compilers):
        parts += members.member_sizes(elf, "LineIntake<", board.compilers) if name == "line_intake_" else [(name, size)]
    rows = [("flash", "firmware", flash_bytes(elf, board.compilers)), ("ram", "pipeline", sum(size for _, size in parts))]
    rows += [("", name.rstrip("_"), size) for name, size in parts if size >= 64]
    return rows + stack_rows(board, elf, results) + instruction_rows(results)


def template_rows(build, board):
    """The flash of a robot's firmware, which has the loop and what goes out on CAN in place of the drive."""
    if board.name != "cortex-m7":  # the template's core
        return []
    return [("", "the template's, its port empty", flash_bytes(boards.program_of(build, "template", "robot.elf"), board.compilers))]


def print_table(board, rows, budget, kept):
    """Prints the table and returns the number of exceeded budgets. A budget without a measurement could never be exceeded, so it is
    refused."""
    measured = {(group, name) for group, name, _ in keyed(rows)}
    for group, names in budget.items():
        for name in names:
            if (group, name) not in measured:
                sys.exit(f"budget.toml: {group}.{name}: nothing of that name is measured; expected one of the rows of tools/budget")
    exceeded, group = 0, ""
    print(f"{board.name:52}{'used':>12}{'allowed':>12}{'change':>12}")
    for head, name, used in rows:
        group = head or group
        allowed = budget.get(group, {}).get(name) if head or name in budget.get(group, {}) else None
        over = allowed is not None and used > allowed
        exceeded += over
        before = kept.get((group, name))
        change = "" if before is None else f"{used - before:+d}"
        text = f"{group} {name}" if allowed is not None else f"  {name}"
        print(f"{text:52}{used:12}{'' if allowed is None else allowed:>12}{change:>12}{'  EXCEEDED' if over else ''}")
    return exceeded


def without_recorded(budget):
    """The budget without the mean of all drives, which is unknown; prints a note."""
    print("instructions.mean: THE RECORDED DRIVES ARE NOT THERE, NOT JUDGED without them", file=sys.stderr)
    return budget | {"instructions": {name: allowed for name, allowed in budget["instructions"].items() if name != "mean"}}


def keyed(rows):
    group = ""
    for head, name, used in rows:
        group = head or group
        yield group, name, used


def check(budget, path):
    """Requires every budget: one that is missing could never be exceeded."""
    for group, names in budget.items():
        if not isinstance(names, dict):
            sys.exit(f"{path}: {group} is {names!r}; expected a table")
    for group, name in BUDGETS:
        allowed = budget.get(group, {}).get(name)
        if type(allowed) is not int:
            sys.exit(f"{path}: {group}.{name} is {'missing' if allowed is None else repr(allowed)}; expected a whole number")


def read_budget(path):
    try:
        budget = tomllib.loads(path.read_text())
    except (OSError, tomllib.TOMLDecodeError) as error:
        sys.exit(f"{path}: {error}; expected the budgets (TOML)")
    check(budget, path)
    return budget


def main(build, name, keep):
    board = boards.BOARDS[name]
    folder = boards.ROOT / "board" / board.folder
    budget = read_budget(folder / "budget.toml")
    kept_file = folder / "measured.csv"
    kept = {(g, n): int(u) for g, n, u in list(csv.reader(kept_file.open()))[1:]} if kept_file.exists() else {}
    rows = measure(board, boards.program_of(build, name).resolve(), run_drives.results_folder(build, name))
    rows[1:1] = template_rows(build, board)
    if not any(run_drives.results_folder(build, name).glob("scan-*.counts")):
        if keep:
            sys.exit(f"--keep: {kept_file} keeps figures of all drives, and the recorded ones are not there")
        budget = without_recorded(budget)
        kept = {key: used for key, used in kept.items() if key[0] != "instructions"}
    exceeded = print_table(board, rows, budget, kept)
    if keep:
        with drives.scoring.whole_file(str(kept_file)) as file:
            csv.writer(file, lineterminator="\n").writerows([("group", "name", "used"), *keyed(rows)])
    return 1 if exceeded else 0


if __name__ == "__main__":
    words = [w for w in sys.argv[1:] if w != "--keep"]
    if len(words) != 2 or words[1] not in (b.name for b in boards.BOARDS.values() if b.budget):
        sys.exit(__doc__)
    sys.exit(main(words[0], words[1], "--keep" in sys.argv))
