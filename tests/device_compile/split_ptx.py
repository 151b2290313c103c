"""Splits a PTX module into modules with some of its entries each, and the functions that these call, so that CUDA's
assembler can work on several at a time."""

import re

STATEMENT = re.compile(r"^\.(?:visible|weak|extern|common|global|const|func|entry|version|target|address_size)\b", re.M)
FUNCTION = re.compile(r"(?:\.(?:visible|weak|extern)\s+)*\.(func|entry)\s*(?:\([^)]*\)\s*)?([\w$]+)")
CALL = re.compile(r"\bcall(?:\.uni)?\s*(?:\([^)]*\)\s*,\s*)?([\w$]+)")


def statements(text):
    """The declarations and definitions of a module, in order."""
    starts = [match.start() for match in STATEMENT.finditer(text)]
    return [text[begin:end] for begin, end in zip(starts, [*starts[1:], len(text)])]


def called_from(entry, calls):
    """The entry, and all functions that it calls."""
    found, waiting = set(), [entry]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting.extend(calls[name])
    return found


def split(text, count):
    """`count` modules of similar size. Each entry is in one of them; functions may be in several."""
    listed = [(statement, FUNCTION.match(statement)) for statement in statements(text)]
    bodies = {match[2]: statement for statement, match in listed if match and "{" in statement}
    entries = [match[2] for statement, match in listed if match and match[1] == "entry" and "{" in statement]
    calls = {name: set(CALL.findall(body)) & bodies.keys() for name, body in bodies.items()}

    def size(names):
        return sum(len(bodies[name]) for name in names)

    needs = {entry: called_from(entry, calls) for entry in entries}
    parts = [set() for _ in range(count)]
    for entry in sorted(entries, key=lambda name: (-size(needs[name]), name)):
        smallest = min(parts, key=lambda part: size(part | needs[entry]))
        smallest |= needs[entry]
    return ["".join(statement for statement, match in listed if not match or match[2] in part) for part in parts]
