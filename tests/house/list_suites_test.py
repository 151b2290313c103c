#!/usr/bin/env python3
"""cmake/list_suites.py writes the ctest entries of a GoogleTest program."""

import fnmatch
import importlib.machinery
import importlib.util
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import house

sys.dont_write_bytecode = True
SCRIPT = house.ROOT / "cmake/list_suites.py"


def load():
    loader = importlib.machinery.SourceFileLoader("list_suites", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("list_suites", loader))
    loader.exec_module(module)
    return module


list_suites = load()

LISTING = """Running main() from gtest_main.cc
Plain.
  First
  Second
SlowPlain.
  First
Environment.
  Reads
  Writes
Scenes/Matrix.
  Bits/mine  # GetParam() = "mine"
  Bits/slit  # GetParam() = "slit. door"
  Bits/x_mine  # GetParam() = "x"
  Resume/mine  # GetParam() = "mine"
  Resume/slit  # GetParam() = "slit. door"
  Resume/x_mine  # GetParam() = "x"
Typed/0.  # TypeParam = float
  Adds
  SharedReference
"""

class Entries(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def text(self, *options, exit_code=0):
        program = self.folder / "program"
        program.write_text(f"#!/bin/sh\ncat <<'END'\n{LISTING}END\nexit {exit_code}\n")
        program.chmod(0o755)
        out = self.folder / "out.cmake"
        command = [sys.executable, SCRIPT, program, out, "--prefix", "p.", "--directory", self.folder, "--timeout", "60", "--slow-timeout", "500", *options]
        self.done = subprocess.run(command, capture_output=True, text=True, check=False)
        return out.read_text() if out.exists() else ""

    def entries(self, *options):
        """Filters of the quick entries, with a process per suite and with one per test, and of the slow ones."""
        parts = re.fullmatch(r"if\(DEFINED ENV\{RELUME_SINGLE_TESTS\}\)\n(.*)else\(\)\n(.*)endif\(\)\n(.*)", self.text(*options), re.DOTALL)
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        single, shared, slow = (dict(re.findall(r"add_test\(\[==\[(.*?)\]==\] .*--gtest_filter=(.*?)\]==\]\)", part)) for part in parts.groups())
        return shared, single, slow

    def test_a_suite_has_one_entry_and_slow_tests_have_one_each(self):
        shared, single, slow = self.entries("--slow=Slow*;*.Resume/mine")
        self.assertEqual(slow, {"p.SlowPlain.First": "SlowPlain.First", "p.Scenes/Matrix.Resume/mine": "Scenes/Matrix.Resume/mine"})
        self.assertEqual(list(shared), ["p.Plain", "p.Environment", "p.Scenes/Matrix", "p.Typed/0"])
        self.assertEqual(shared["p.Plain"], "Plain.*")
        self.assertEqual(shared["p.Scenes/Matrix"].count(":"), 4, "five quick tests by name")
        self.assertNotIn("Scenes/Matrix.Resume/mine", shared["p.Scenes/Matrix"].split(":"))
        self.assertEqual(len(single), 11)

    def test_tests_of_a_parameter_stay_together(self):
        shared, _, _ = self.entries("--slow=Slow*", "--most=4")
        self.assertEqual(shared["p.Scenes/Matrix_0"], "Scenes/Matrix.Bits/mine:Scenes/Matrix.Bits/x_mine:Scenes/Matrix.Resume/mine:Scenes/Matrix.Resume/x_mine")
        self.assertEqual(shared["p.Scenes/Matrix_1"], "Scenes/Matrix.Bits/slit:Scenes/Matrix.Resume/slit")

    def test_every_test_is_in_one_entry(self):
        for most in range(1, 8):
            shared, single, slow = self.entries("--slow=Slow*", f"--most={most}")
            patterns = [pattern for filters in shared.values() for pattern in filters.split(":")]
            names = [test for pattern in patterns for test in single.values() if fnmatch.fnmatchcase(test, pattern)]
            self.assertEqual(sorted(names), sorted(single.values()), most)
            self.assertEqual(list(slow), ["p.SlowPlain.First"])

    def test_suites_can_run_alone_and_tests_can_be_left_out(self):
        shared, _, _ = self.entries("--slow=Slow*", "--alone=Environment;Matrix", "--omit=*Shared*")
        self.assertEqual(shared["p.Environment.Reads"], "Environment.Reads")
        self.assertEqual(shared["p.Scenes/Matrix.Bits/slit"], "Scenes/Matrix.Bits/slit")
        self.assertEqual(shared["p.Typed/0"], "Typed/0.Adds")

    def test_limits_and_costs_grow_with_the_number_of_tests(self):
        text = self.text("--slow=Slow*", "--cost=0.5", "--properties=LABELS;x")
        self.assertIn("[==[TIMEOUT]==] [==[65]==] [==[COST]==] [==[3]==] [==[LABELS]==] [==[x]==])\n", text, "six tests")
        self.assertIn("[==[TIMEOUT]==] [==[500]==]", text)

    def test_only_entries_without_a_result_are_skipped(self):
        skipped = re.compile(list_suites.SKIPPED.replace("$", r"\Z"))
        ran = "[==========] 2 tests from 1 test suite ran. (1 ms total)\n"
        of_one = "[  SKIPPED ] 1 test, listed below:\n[  SKIPPED ] A.B\n"
        self.assertTrue(skipped.search(f"{ran}[  PASSED  ] 0 tests.\n{of_one}"))
        self.assertFalse(skipped.search(f"{ran}[  PASSED  ] 1 test.\n{of_one}"))
        self.assertFalse(skipped.search(f"{ran}[  PASSED  ] 0 tests.\n{of_one}[  FAILED  ] 1 test, listed below:\n[  FAILED  ] A.C\n\n 1 FAILED TEST\n"))
        self.assertFalse(skipped.search(f"{ran}[  PASSED  ] 10 tests.\n{of_one}"))

    def test_a_program_that_fails_is_reported(self):
        self.assertEqual(self.text(exit_code=3), "")
        self.assertIn("fails with exit code 3", self.done.stderr)


if __name__ == "__main__":
    unittest.main()
