#!/usr/bin/env python3
"""The PTX of the kernels: an entry for each kernel that the library launches, and only instructions with the host's results.
Building tests/device fails if the translator does not know an instruction.
RELUME_NM, RELUME_CXXFILT: tools; RELUME_LIBRARY, RELUME_PTX: what is compared; RELUME_CLANG, RELUME_CLANG_FLAGS: the compiler."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER), str(FOLDER.parent / "ptx" / "translator")]

from device_module import device_module
from emitter import external_functions, opcode_counts
from kernel_names import compiled_kernels, launched_kernels, symbols_of
from parser import parse

# Two roundings on the host; one if the compiler fuses them.
CONTRACTION = """#include "core/hd.h"
__global__ void k(float* x) { x[0] = x[0] * x[1] + x[2]; }
"""


def demangled(names):
    text = "\n".join(names) + "\n"
    return subprocess.run([os.environ["RELUME_CXXFILT"]], input=text, check=True, capture_output=True, text=True).stdout


def opcodes_with(module, part):
    """Opcodes that have a modifier or begin with a name, with their counts."""
    return {o: n for o, n in opcode_counts(module).items() if part in o.split(".")}


class DeviceCode(unittest.TestCase):
    maxDiff = None
    @classmethod
    def setUpClass(cls):
        cls.module = device_module()
        cls.entries = [f for f in cls.module.functions if f.entry]

    def test_every_launched_kernel_has_an_entry(self):
        launched = launched_kernels(symbols_of(os.environ["RELUME_NM"], os.environ["RELUME_LIBRARY"]))
        compiled = compiled_kernels(demangled(f.name for f in self.entries))
        self.assertGreater(len(launched), 40)
        self.assertEqual(sorted(launched - compiled), [], "launched, but without an entry")

    def test_entries_take_a_window_and_find_their_kernel_in_constant_memory(self):
        for entry in self.entries:
            count = 2 if "run_group" in entry.name else 4
            self.assertEqual([p.size for p in entry.parameters], [4] * count, entry.name)
        sizes = {v.name: (v.space, v.size, v.alignment) for v in self.module.variables}
        self.assertEqual(sizes["relume_kernel"], ("const", 4096, 64))

    def test_the_version_is_one_that_old_drivers_take(self):
        self.assertEqual((self.module.version, self.module.target), ("6.3", "sm_75"))

    def test_no_instruction_fuses_approximates_or_flushes(self):
        for part in ("fma", "approx", "full", "ftz"):
            self.assertEqual(opcodes_with(self.module, part), {}, part)

    def test_no_function_is_missing(self):
        self.assertEqual(demangled(external_functions(self.module)).split(), [])

    def test_kernels_share_one_copy_of_the_ray_queries(self):
        names = demangled({f.name for f in self.module.functions if f.body})
        for query in ("traverse_to_nearest", "traverse_to_any", "opacity_in"):
            self.assertEqual(len(re.findall(rf"\brelume::{query}<", names)), 1, query)

    def test_contraction_is_noticed(self):
        for mode, fused in (("off", 0), ("fast", 1)):
            with tempfile.TemporaryDirectory() as work:
                source, target = pathlib.Path(work) / "k.cu", pathlib.Path(work) / "k.ptx"
                source.write_text(CONTRACTION, encoding="utf-8")
                flags = os.environ["RELUME_CLANG_FLAGS"].split()
                subprocess.run([os.environ["RELUME_CLANG"], *flags, f"-ffp-contract={mode}", source, "-o", target], check=True)
                module = parse(target.read_text(encoding="utf-8"), str(target))
            self.assertEqual(sum(opcodes_with(module, "fma").values()), fused)


if __name__ == "__main__":
    unittest.main()
