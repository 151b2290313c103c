"""Tests of the names of kernels that are read from symbols, and of the check that stops the build."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

from kernel_names import compiled_kernels, launched_kernels

SYMBOLS = """
0000000000000000 t bool relume::launch_on_device<relume::Sum<relume::View<float> > >(relume::Backend&, relume::Tile const&)
0000000000000000 t bool relume::launch_on_device<relume::(anonymous namespace)::Fill>(relume::Backend&)
0000000000000000 W bool relume::launch<relume::(anonymous namespace)::Fill>(relume::Backend&)
0000000000000000 W void relume::device::run<relume::Copy>(unsigned int)
0000000000000000 W void relume::device::run_group<relume::Sort>(unsigned int)
"""


class KernelNames(unittest.TestCase):
    def test_launches_are_found_where_launch_itself_is_inlined(self):
        names = {"relume::Sum<relume::View<float> >", "relume::(anonymous namespace)::Fill"}
        self.assertEqual(launched_kernels(SYMBOLS), names)

    def test_entries_of_both_kinds_are_found(self):
        self.assertEqual(compiled_kernels(SYMBOLS), {"relume::Copy", "relume::Sort"})


class Check(unittest.TestCase):
    LAUNCHED = [f"relume::Kernel{i}" for i in range(50)]

    def check(self, compiled):
        """Runs check_launched_kernels.py on a library that launches 50 kernels, and on an object with others."""
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            nm = folder / "nm"
            nm.write_text('#!/bin/sh\ncat "$2"\n', encoding="utf-8")  # nm -C FILE
            nm.chmod(0o755)
            launches = (f"bool relume::launch_on_device<{kernel}>(int)\n" for kernel in self.LAUNCHED)
            entries = (f"void relume::device::run<{kernel}>(int)\n" for kernel in compiled)
            (folder / "library").write_text("".join(launches), encoding="utf-8")
            (folder / "object").write_text("".join(entries), encoding="utf-8")
            script = pathlib.Path(__file__).with_name("check_launched_kernels.py")
            return subprocess.run([sys.executable, script, nm, folder / "library", folder / "object"],
                                  capture_output=True, text=True, check=False)

    def test_complete_lists_pass(self):
        done = self.check([*self.LAUNCHED, "relume::Unused"])
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_launched_kernel_in_no_list_stops_the_build(self):
        done = self.check(self.LAUNCHED[:-1])
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr, "launched, but in no kernels.inc:\n  relume::Kernel49\n")

    def test_missing_symbols_stop_the_build(self):
        self.assertIn("their symbols are missing", self.check([]).stderr)


if __name__ == "__main__":
    unittest.main()
