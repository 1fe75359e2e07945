#!/usr/bin/env python3
"""stack.py ELF FUNCTION [PREFIX]: worst-case stack of a function of a firmware, and the path of calls that needs it. PREFIX is that of
its binutils: arm-none-eabi-.

Computed from the compiler's call graph (-fcallgraph-info=su,da); functions of the linker and the C library are read from the
disassembly. Recursion and calls through pointers are refused, because their depth is not known."""
import re
import sys
from pathlib import Path

from stages import run

NODE = re.compile(r'node: \{ title: "([^"]*)" label: "([^"]*)"')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"')
BRANCH = re.compile(r"(b|bl|bx|blx)(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)?")
SIZE = re.compile(r"(\d+) bytes \((static|dynamic[^)]*)\)")


def bare(title):
    """The linker's name: titles of static functions have their file before a colon."""
    return title.rsplit(":", 1)[-1]


class CallGraph:
    def __init__(self, build, elf, prefix):
        self.bytes, self.calls, self.names, self.unbounded = {}, {}, {}, set()
        graphs = sorted(Path(build).rglob("*.ci"))
        if not graphs:
            sys.exit(f"{build}: no call graph; expected a build with -fcallgraph-info=su,da, not out of a compiler cache")
        target_of = {path: re.search(r"CMakeFiles/(\S+\.elf)\.dir/", str(path)) for path in graphs}
        self.read([path for path, target in target_of.items() if target and target[1] == elf.name])
        self.read([path for path, target in target_of.items() if not target])  # of libraries, which may not be part of this program
        self.add_library_functions(elf, prefix)

    def read(self, graphs):
        """Adds the functions that are not known yet: the linker takes what is defined in several places from the program's own objects first."""
        known = set(self.bytes)
        for text in (path.read_text() for path in graphs):
            for title, label in NODE.findall(text):
                size = SIZE.search(label)
                if size and bare(title) not in known:
                    self.bytes[bare(title)] = int(size[1])
                    self.names[bare(title)] = label.split("\\n")[0]
                    if size[2] == "dynamic":
                        self.unbounded.add(bare(title))
            for source, target in EDGE.findall(text):
                if bare(source) not in known:
                    self.calls.setdefault(bare(source), set()).add(bare(target))

    def add_library_functions(self, elf, prefix):
        """Adds functions without call graphs from the disassembly: registers pushed, stack allocated and calls, instruction by
        instruction."""
        listing = run([prefix + "objdump", "-d", "--no-show-raw-insn", elf])
        name = None
        for line in listing.splitlines():
            if begin := re.match(r"[0-9a-f]+ <([^>]+)>:", line):
                name = begin[1]
                if name in self.bytes:
                    name = None
                else:
                    self.bytes[name] = 0
            elif name:
                self.read_instruction(name, line)

    def read_instruction(self, name, line):
        words = line.split("\t")
        if len(words) < 2:
            return
        operation, operands = words[1].split(".")[0], words[2] if len(words) > 2 else ""
        if operation in ("push", "stmdb", "vpush") and (operation != "stmdb" or operands.startswith("sp!")):
            self.bytes[name] += (8 if operation == "vpush" and "d" in operands else 4) * registers(operands)
        elif operation in ("sub", "subw", "subs") and (taken := re.match(r"sp, (?:sp, )?#(\d+)", operands)):
            self.bytes[name] += int(taken[1])
        elif operation in ("str", "strd") and (taken := re.search(r"\[sp, #-(\d+)\]!", operands)):
            self.bytes[name] += int(taken[1])
        elif BRANCH.fullmatch(operation) and (target := re.search(r"<([^+>]+)>|^(?:r\d+|ip)\b", operands)) and target[1] != name:
            self.calls.setdefault(name, set()).add(target[1] or "__indirect_call")

    def worst(self, root):
        """(bytes, [functions of the deepest path]) of a function and what it calls; named by its linker name, or by a part of its readable
        name that is unique."""
        found = [root] if root in self.bytes else [n for n in self.bytes if root in self.names.get(n, n)]
        if len(found) != 1:
            sys.exit(f"{root}: {len(found)} functions of that name in the call graph; expected one")
        self.deepest = {}
        return self.walk(found[0], [])

    def walk(self, name, above):
        if name in above:
            sys.exit(f"recursion, whose depth is not known: {' -> '.join(above[above.index(name):] + [name])}")
        if name == "__indirect_call":
            sys.exit(f"a call through a pointer, whose target is not known, in {self.names.get(above[-1], above[-1])}")
        if name in self.unbounded:
            sys.exit(f"{self.names.get(name, name)} takes stack without a bound")
        if name not in self.bytes:
            sys.exit(f"{name}: called from {above[-1]}, not in the program; expected its code to know its stack")
        if name not in self.deepest:
            below = [self.walk(callee, above + [name]) for callee in sorted(self.calls.get(name, ()))]
            size, path = max(below, default=(0, []))
            self.deepest[name] = (self.bytes[name] + size, [name] + path)
        return self.deepest[name]


def registers(operands):
    """The number of registers in a list such as {r4, r5-r7, lr}."""
    count = 0
    for part in re.search(r"\{([^}]*)\}", operands)[1].split(","):
        ends = [int(n) if n else 0 for n in re.findall(r"[rsd](\d+)", part)]
        count += ends[1] - ends[0] + 1 if len(ends) == 2 else 1
    return count


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    elf = Path(sys.argv[1])
    worst, path = CallGraph(elf.parent, elf, (sys.argv[3:] or ["arm-none-eabi-"])[0]).worst(sys.argv[2])
    print(worst, *path, sep="\n  ")
