"""Bytes of each member of a class, from a firmware's debug information."""
import re
import subprocess

ENTRY = re.compile(r" <(\d+)><([0-9a-f]+)>: Abbrev Number: \d+ \(DW_TAG_(\w+)\)")
ATTRIBUTE = re.compile(r"    <[0-9a-f]+>\s+DW_AT_(\w+)\s*:\s*(.*?)\s*$")


def entries(elf, prefix):
    """(depth, tag, {attribute: value}) of every entry, in order."""
    out = subprocess.Popen([prefix + "objdump", "--dwarf=info", elf], stdout=subprocess.PIPE, text=True)
    entry = None
    for line in out.stdout:
        if begin := ENTRY.match(line):
            if entry:
                yield entry
            entry = (int(begin[1]), begin[3], {})
        elif entry and (attribute := ATTRIBUTE.match(line)):
            entry[2][attribute[1]] = attribute[2]
    if entry:
        yield entry
    if out.wait() != 0:
        raise SystemExit(f"{elf}: its debug information cannot be read")


def name_of(attributes):
    return attributes.get("name", "").rsplit("): ", 1)[-1]


def member_sizes(elf, class_name, prefix):
    """[(member, bytes up to the next)] in order of address, for the first complete class whose name begins with class_name."""
    members, size, inside = [], 0, None
    for depth, tag, attributes in entries(elf, prefix):
        if inside is None:
            if tag in ("class_type", "structure_type") and name_of(attributes).startswith(class_name) and "byte_size" in attributes:
                inside, size = depth, int(attributes["byte_size"], 0)
        elif depth <= inside:
            break
        elif depth == inside + 1 and tag == "member" and "data_member_location" in attributes:
            members.append((int(attributes["data_member_location"], 0), name_of(attributes)))
    members.sort()
    ends = [at for at, _ in members[1:]] + [size]
    return [(name, end - at) for (at, name), end in zip(members, ends)]
