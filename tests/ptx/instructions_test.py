#!/usr/bin/env python3
"""Instructions of the PTX executor against the ISA: every instruction that the translator knows, on special and random values.
The results come from vectors/*.py, which compute with exact integers and fractions. PTX_RUN_TRIALS: the program run_trials."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
from collections import Counter

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER / "vectors"), str(FOLDER / "translator")]

from forms import FORMS
from suite import all_trials, input_bytes, read_outputs

SHOWN = 20


def in_hex(values):
    return ", ".join(f"{v:#x}" for v in values)


class Instructions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.trials = all_trials()

    def test_every_known_instruction_is_tested(self):
        tested = Counter(opcode for t in self.trials for opcode in (t.opcode, *t.others))
        self.assertEqual(sorted(set(FORMS) - set(tested)), [], "known, but not tested")
        self.assertEqual(sorted(set(tested) - set(FORMS)), [], "tested, but not known")
        self.assertEqual([name for name, count in tested.items() if count > 1], [], "tested twice")
        self.assertEqual([t.opcode for t in self.trials if not t.rows], [], "without rows")

    def test_results_are_those_of_the_isa(self):
        with tempfile.TemporaryDirectory() as work:
            given, results = pathlib.Path(work) / "in", pathlib.Path(work) / "out"
            given.write_bytes(input_bytes(self.trials))
            subprocess.run([os.environ["PTX_RUN_TRIALS"], given, results], check=True, timeout=600)
            found = read_outputs(results.read_bytes(), self.trials)
        wrong, rows = [], 0
        for trial, (fault, outputs) in zip(self.trials, found):
            if fault != trial.fault:
                wrong.append(f"{trial.opcode}: ended with '{fault}', expected '{trial.fault}'")
            for (inputs, expected), result in zip(trial.rows, outputs if not trial.fault else []):
                rows += 1
                if tuple(result) != tuple(expected):
                    wrong.append(f"{trial.opcode}({in_hex(inputs)}) = {in_hex(result)}; expected {in_hex(expected)}")
        self.assertEqual(len(wrong), 0, f"{len(wrong)} of {rows} results are wrong:\n" + "\n".join(wrong[:SHOWN]))
        print(f"{rows} rows of inputs for {len(FORMS)} instructions")


if __name__ == "__main__":
    unittest.main()
