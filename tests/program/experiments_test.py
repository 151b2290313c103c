#!/usr/bin/env python3
"""Runs every small experiment with one command, and checks the outputs listed by its index. Verdicts require full runs
(docs/results.md): images of 32 × 18 pixels are not conclusive."""

import json
import os
import pathlib
import shutil
import unittest

from program import ProgramTest, run

PUBLISHED = pathlib.Path(__file__).resolve().parents[2] / "docs/results/experiments"
VERDICTS = {"holds", "does not hold", "undecided", "not measured"}


class Experiments(ProgramTest):
    def test_all_of_them_run(self):
        listed = [line.split()[0] for line in self.succeed("experiment", "list").stdout.splitlines() if line.strip()]
        self.assertGreater(len(listed), 16)
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        self.succeed("experiment", "run", "--all", "--quick", "-o", "out", timeout=1500, env=environment)
        index = (self.folder / "out/index.html").read_text()
        tables = (self.folder / "out/index.md").read_text()
        for name in listed:
            with self.subTest(experiment=name):
                result = json.loads((self.folder / f"out/{name}.json").read_text())
                self.assertTrue(result["quick"])
                self.assertGreater(len(result["claims"]), 0)
                for claim in result["claims"]:
                    self.assertIn(claim["verdict"], VERDICTS)
                    self.assertNotRegex(claim["measured"], r"\b(nan|inf)\b")
                    if claim["verdict"] != "not measured":
                        self.assertRegex(claim["measured"], r"\d")
                self.assertIn("</html>", (self.folder / f"out/{name}.html").read_text())
                self.assertIn(f"{name}.html", index)
                self.assertIn(f"\n## {name}\n", tables)

    def test_threads_are_bounded_and_recorded(self):
        self.succeed("experiment", "run", "psf-frametime", "--quick", "-o", "out", "--cache-dir", "cache", "--threads", "1", timeout=300)
        result = json.loads((self.folder / "out/psf-frametime.json").read_text())
        self.assertEqual(result["machine"]["Threads"], "1 at most")
        self.assertEqual(run("experiment", "run", "psf-frametime", "--threads", "many", cwd=self.folder).returncode, 2)

    def test_one_that_fails_leaves_the_others_be(self):
        (self.folder / "scenes/sponza").mkdir(parents=True)
        (self.folder / "scenes/sponza/sponza.gltf").write_text("no glTF")
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        done = run("experiment", "run", "psf-frametime", "bdpt-cost", "vlc-adaptation", "--quick", "--scenes", "scenes", "-o", "out", cwd=self.folder, env=environment, timeout=600)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr.splitlines()[-1], r"2 of 3 experiments failed: psf-frametime, bdpt-cost")
        self.assertIn("\n## vlc-adaptation\n", (self.folder / "out/index.md").read_text())

    def test_continue_skips_current_results(self):
        command = ["experiment", "run", "psf-frametime", "--quick", "-o", "out", "--cache-dir", "cache"]
        self.succeed(*command, timeout=300)
        file = self.folder / "out/psf-frametime.json"
        result = json.loads(file.read_text())
        self.assertFalse(result["scenes"])
        self.assertGreater(len(result["tables"]), 0)
        stays = self.succeed(*command, "--continue").stderr
        self.assertIn("psf-frametime is in out already\n", stays)
        result["program"] = "another"
        file.write_text(json.dumps(result))
        self.assertIn("measured by another build of relume", self.succeed(*command, "--continue").stderr)
        # A scene folder requires a new measurement, which fails on these unreadable files.
        (self.folder / "scenes/sponza").mkdir(parents=True)
        (self.folder / "scenes/sponza/sponza.gltf").write_text("no glTF")
        done = run("experiment", "run", "psf-frametime", "--quick", "-o", "out", "--cache-dir", "cache", "--scenes", "scenes", "--continue", cwd=self.folder, timeout=300)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("sponza.gltf", done.stderr)

    def test_the_index_of_published_results_has_their_claims(self):
        shutil.copytree(PUBLISHED, self.folder / "out")
        files = sorted(PUBLISHED.glob("*.json"))
        self.succeed("experiment", "run", *(file.stem for file in files), "--continue", "-o", "out")
        tables = (self.folder / "out/index.md").read_text()
        for file in files:
            for claim in json.loads(file.read_text())["claims"]:
                self.assertIn(" | ".join(("", claim["claim"], claim["measured"], claim["threshold"], claim["verdict"], "")).strip(), tables)


if __name__ == "__main__":
    unittest.main()
