#!/usr/bin/env python3
"""tools/guarantees fills in the claims of stored runs on the pages of results."""

import importlib.machinery
import importlib.util
import sys
import unittest

import house

sys.dont_write_bytecode = True


def load():
    loader = importlib.machinery.SourceFileLoader("guarantees", str(house.ROOT / "tools/guarantees"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("guarantees", loader))
    loader.exec_module(module)
    return module


guarantees = load()
PAGE = "# A\n\n<!-- claims: readapt -->\nstale\n<!-- end -->\n\n<!-- claims: no-reuse -->\n<!-- end -->\nend\n"
RESULT = {
    "seconds": 600, "machine": {"Date": "1 May", "Processor": "P", "Program": "relume 1"},
    "claims": [{"paper": "[X]", "claim": "a | b", "measured": "2", "threshold": "at most 3", "verdict": "holds"}],
}  # fmt: skip


class Blocks(unittest.TestCase):
    def test_are_filled_with_claims_or_say_that_no_run_is_stored(self):
        text = guarantees.filled("reservoirs", PAGE, {"readapt": RESULT})
        self.assertIn("Full run: 10 minutes on 1 May; P; relume 1.\n\n| paper |", text)
        self.assertIn("| [X] | a \\| b | 2 | at most 3 | holds |\n\n<!-- end -->", text)
        self.assertIn("<!-- claims: no-reuse -->\n`no-reuse` has no stored run yet.\n<!-- end -->\nend\n", text)
        self.assertNotIn("stale", text)
        self.assertEqual(guarantees.filled("reservoirs", text, {"readapt": RESULT}), text)

    def test_belong_to_the_page_of_the_experiment(self):
        with self.assertRaisesRegex(SystemExit, "docs/results/caches.md has a block of readapt"):
            guarantees.filled("caches", PAGE, {})

    def test_every_experiment_without_a_section_of_its_own_has_one(self):
        text = (guarantees.RESULTS / "reservoirs.md").read_text(encoding="utf-8")
        self.assertEqual([match[1] for match in guarantees.BLOCK.findall(text)], list(guarantees.PAGES["reservoirs"]))


if __name__ == "__main__":
    unittest.main()
