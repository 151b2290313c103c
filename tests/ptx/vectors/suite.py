#!/usr/bin/env python3
"""suite.py OUT.ptx: writes a module with an entry for each trial. The functions below also write what run_trials.cpp reads, and
read what it writes."""

import pathlib
import struct
import sys

import integers
import memory
import reals
import threads
from trial import WIDTH, Trial

SLOT = 8  # bytes of an input or output in memory

HEAD = """.version 6.3
.target sm_75
.address_size 64
"""


def faults():
    """Instructions that end the launch with an error."""
    return [Trial(name, f"mov.b32 %d0, %a0;\n{name};", ("b32",), ("b32",), [((0,), (0,))], fault=fault)
            for name, fault in (("trap", "trap"), ("brkpt", "breakpoint"))]


def all_trials():
    return integers.trials() + reals.trials() + memory.trials() + threads.trials() + faults()


def load_input(i, kind):
    at = f"[%i+{SLOT * i}]"
    if kind == "pred":
        return f"ld.global.u32 %t, {at};\nsetp.ne.u32 %a{i}, %t, 0;"
    return f"ld.global.{kind} %a{i}, {at};"


def store_output(i, kind):
    at = f"[%o+{SLOT * i}]"
    if kind == "pred":
        return f"selp.u32 %t, 1, 0, %d{i};\nst.global.u32 {at}, %t;"
    return f"st.global.{kind} {at}, %d{i};"


def entry_text(name, trial):
    lines = [trial.declarations, f".visible .entry {name}(.param .u64 in, .param .u64 out, .param .u64 memory)", "{"]
    lines += [".reg .b64 %i, %o, %m;", ".reg .b32 %n, %t;"]
    lines += ["ld.param.u64 %i, [in];", "ld.param.u64 %o, [out];", "ld.param.u64 %m, [memory];"]
    lines += [f".reg .{kind} %a{i};" for i, kind in enumerate(trial.inputs)]
    lines += [f".reg .{kind} %d{i};" for i, kind in enumerate(trial.outputs)]
    if trial.threads:
        lines.append("mov.u32 %n, %tid.x;")
        for register, slots in (("i", len(trial.inputs)), ("o", len(trial.outputs))):
            lines.append(f"mad.wide.u32 %{register}, %n, {SLOT * slots}, %{register};")
    lines += [load_input(i, kind) for i, kind in enumerate(trial.inputs)]
    lines.append(trial.body)
    lines += [store_output(i, kind) for i, kind in enumerate(trial.outputs)]
    return "\n".join([*lines, "ret;", "}", ""])


def module_text(trials):
    return HEAD + "\n".join(entry_text(f"trial{i}", t) for i, t in enumerate(trials))


def input_bytes(trials):
    """For each trial a line `entry rows threads inputs outputs`, then the inputs of all rows as 64-bit words."""
    parts = []
    for i, t in enumerate(trials):
        parts.append(f"trial{i} {len(t.rows)} {max(t.threads, 1)} {len(t.inputs)} {len(t.outputs)}\n".encode())
        values = [value for row, _ in t.rows for value in row]
        parts.append(struct.pack(f"<{len(values)}Q", *values))
    return b"".join(parts)


def read_outputs(data, trials):
    """For each trial (fault or "", the outputs of its rows)."""
    found, at = [], 0
    for t in trials:
        end = data.index(b"\n", at)
        fault = data[at:end].decode()
        at = end + 1
        width = len(t.outputs)
        values = struct.unpack_from(f"<{len(t.rows) * width}Q", data, at)
        at += SLOT * len(values)
        found.append((fault, [values[width * r : width * (r + 1)] for r in range(len(t.rows))]))
    return found


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    pathlib.Path(sys.argv[1]).write_text(module_text(all_trials()), encoding="utf-8")
