#!/usr/bin/env python3
"""Checks spelling and wording of the program's help."""

import pathlib
import shutil
import sys
import unittest

from program import ProgramTest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "house"))
import check_spelling  # noqa: E402
import check_wording  # noqa: E402

COMMANDS = ("render", "view", "serve", "scenes", "export", "info", "metrics", "merge", "compare", "experiment", "survey", "settings", "devices", "man", "completion")


class Wording(ProgramTest):
    def setUp(self):
        super().setUp()
        self.texts = {command: self.succeed(command, "--help-all").stdout for command in COMMANDS}
        self.texts["help"] = self.succeed("--help").stdout
        for line in ("scenes", "devices", "settings --markdown", "experiment list", "survey --list"):
            self.texts[line.replace(" ", "_")] = self.succeed(*line.split()).stdout

    def test_every_command_is_read(self):
        listed = self.texts["help"].split("Commands:")[1].split("\n\n")[0]
        self.assertEqual([line.split()[0] for line in listed.splitlines() if line.startswith("  ")], list(COMMANDS))

    def test_wording(self):
        found = {name: check_wording.calques(" ".join(text.split())) for name, text in self.texts.items()}
        self.assertEqual({name: calques for name, calques in found.items() if calques}, {})

    @unittest.skipIf(shutil.which("codespell") is None, "no codespell")
    def test_spelling(self):
        self.assertEqual(check_spelling.misspelt(self.texts), [])


if __name__ == "__main__":
    unittest.main()
