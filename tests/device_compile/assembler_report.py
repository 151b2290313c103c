"""What CUDA's assembler reports about each kernel: the messages of `ptxas -v`."""

import re
from dataclasses import dataclass

PROPERTIES = re.compile(
    r"Function properties for (\S+)\s+(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads")
REGISTERS = re.compile(r"Used (\d+) registers(?:[^\n]*?(\d+) bytes cumulative stack size)?")
ENTRY = re.compile(r"Compiling entry function '([^']+)'")


@dataclass(frozen=True)
class Usage:
    """Of a function. Registers of a thread; bytes of a thread's stack; bytes that its instructions spill and reload."""

    registers: int  # of a kernel, with the functions that it calls; 0: not a kernel
    stack: int  # of a kernel, along the deepest chain of calls; else of the function alone
    spill_stores: int
    spill_loads: int


def parse_report(text):
    """The kernels, and the other functions, each by name."""
    functions = {name: Usage(0, int(frame), int(stores), int(loads))
                 for name, frame, stores, loads in PROPERTIES.findall(text)}
    kernels = {}
    parts = ENTRY.split(text)
    for name, part in zip(parts[1::2], parts[2::2]):
        used = REGISTERS.search(part)
        if not used:
            raise ValueError(f"the report has no registers of '{name}'")
        own = functions.pop(name, Usage(0, 0, 0, 0))
        stack = max(own.stack, int(used[2] or 0))
        kernels[name] = Usage(int(used[1]), stack, own.spill_stores, own.spill_loads)
    return kernels, functions


def spilling(usages, most):
    """The functions whose instructions store or load more than `most` bytes of spilled registers."""
    return {name: u for name, u in usages.items() if max(u.spill_stores, u.spill_loads) > most}


def table(usages, title_of):
    """A line for each function, the largest stack first. `title_of(name)`: its name for people."""
    lines = ["registers   stack  spill stores  spill loads  function"]
    for name, u in sorted(usages.items(), key=lambda item: (-item[1].stack, item[0])):
        lines.append(f"{u.registers or '':>9}{u.stack:>8}{u.spill_stores:>14}{u.spill_loads:>13}  {title_of(name)}")
    return "\n".join(lines) + "\n"
