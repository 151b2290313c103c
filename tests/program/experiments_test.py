#!/usr/bin/env python3
"""Runs small experiments, and checks the outputs listed by the index: in the quick tests one of each kind of measurement, in
the slow tests all others. Verdicts require full runs (docs/results.md): images of 32 × 18 pixels are not conclusive."""

import json
import os
import pathlib
import shutil
import sys
import unittest

from program import ProgramTest, run

PUBLISHED = pathlib.Path(__file__).resolve().parents[2] / "docs/results/experiments"
# For each file of lab/experiments/measure, an experiment that uses it; for learning_modes.h, that is vlc-adaptation in Options.
ONE_OF_EACH_KIND = ("apg-depth", "caustics", "combination", "guide-cost", "psf-variance", "readapt", "restir-bias", "restir-correlation", "upscaling")
VERDICTS = {"holds", "does not hold", "undecided", "not measured"}


class Experiments(ProgramTest):
    def names(self):
        listed = [line.split()[0] for line in self.succeed("experiment", "list").stdout.splitlines() if line.strip()]
        self.assertGreater(len(listed), 16)
        return listed

    def check(self, names):
        """Runs experiments with one thread: the small images have few tiles, for which a second thread would mostly wait."""
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        self.succeed("experiment", "run", *names, "--quick", "--threads", "1", "-o", "out", timeout=1500, env=environment)
        index = (self.folder / "out/index.html").read_text()
        tables = (self.folder / "out/index.md").read_text()
        for name in names:
            with self.subTest(experiment=name):
                result = json.loads((self.folder / f"out/{name}.json").read_text())
                print(f"{name}: {result['seconds']:.1f} s", file=sys.stderr)
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


class OneOfEachKind(Experiments):
    def test_they_run(self):
        self.assertEqual(set(ONE_OF_EACH_KIND) - set(self.names()), set())
        self.check(ONE_OF_EACH_KIND)


class OtherExperiments(Experiments):
    """Each test runs a third, so that the tests can run in parallel."""

    def check_part(self, part):
        self.check([name for name in self.names() if name not in ONE_OF_EACH_KIND][part::3])

    def test_first(self):
        self.check_part(0)

    def test_second(self):
        self.check_part(1)

    def test_third(self):
        self.check_part(2)


class Options(Experiments):
    def test_one_that_fails_leaves_the_others_be(self):
        (self.folder / "scenes/sponza").mkdir(parents=True)
        (self.folder / "scenes/sponza/sponza.gltf").write_text("no glTF")
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        done = run("experiment", "run", "psf-frametime", "bdpt-cost", "vlc-adaptation", "--quick", "--threads", "1", "--scenes", "scenes", "-o", "out", cwd=self.folder, env=environment, timeout=600)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr.splitlines()[-1], r"2 of 3 experiments failed: psf-frametime, bdpt-cost")
        self.assertIn("\n## vlc-adaptation\n", (self.folder / "out/index.md").read_text())

    def test_continue_skips_current_results(self):
        command = ["experiment", "run", "psf-frametime", "--quick", "-o", "out", "--cache-dir", "cache"]
        self.assertEqual(run(*command, "--threads", "many", cwd=self.folder).returncode, 2)
        self.succeed(*command, "--threads", "1", timeout=300)
        file = self.folder / "out/psf-frametime.json"
        result = json.loads(file.read_text())
        self.assertEqual(result["machine"]["Threads"], "1 at most")
        self.assertEqual(result["machine"]["Device"], "processor")
        self.assertFalse(result["scenes"])
        self.assertGreater(len(result["tables"]), 0)
        messages = self.succeed(*command, "--continue").stderr
        self.assertIn("psf-frametime is in out already\n", messages)
        result["program"] = "another"
        file.write_text(json.dumps(result))
        self.assertIn("measured by another build of relume", self.succeed(*command, "--continue").stderr)
        # A scene folder requires a new measurement, which fails on these unreadable files.
        (self.folder / "scenes/sponza").mkdir(parents=True)
        (self.folder / "scenes/sponza/sponza.gltf").write_text("no glTF")
        done = run("experiment", "run", "psf-frametime", "--quick", "-o", "out", "--cache-dir", "cache", "--scenes", "scenes", "--continue", cwd=self.folder, timeout=300)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("sponza.gltf", done.stderr)

    def test_the_index_of_all_has_the_claims_of_published_results(self):
        out = self.folder / "out"
        shutil.copytree(PUBLISHED, out)
        files = sorted(PUBLISHED.glob("*.json"))
        names = self.names()
        for name in names:
            if not (out / f"{name}.json").exists():  # not published
                (out / f"{name}.json").write_text(json.dumps(dict(json.loads(files[0].read_text()), name=name)))
        messages = self.succeed("experiment", "run", "--all", "--continue", "-o", "out").stderr
        tables = (out / "index.md").read_text()
        for name in names:
            self.assertIn(f"{name} is in out already", messages)
            self.assertIn(f"\n## {name}\n", tables)
        for file in files:
            for claim in json.loads(file.read_text())["claims"]:
                self.assertIn(" | ".join(("", claim["claim"], claim["measured"], claim["threshold"], claim["verdict"], "")).strip(), tables)


class Survey(ProgramTest):
    COMMAND = ("survey", "--quick", "--threads", "1", "-o", "out", "--cache-dir", "cache", "--techniques", "cache,vlc + svgf")

    def survey(self):
        return json.loads((self.folder / "out/all.json").read_text())

    def test_continues_scene_by_scene(self):
        self.assertIn("measured 7 of 7 techniques in cornell", self.succeed(*self.COMMAND, "--scenes", "cornell", timeout=300).stderr)
        before = self.survey()["scenes"][0]
        messages = self.succeed(*self.COMMAND, "--scenes", "cornell,furnace", timeout=300).stderr
        self.assertNotIn("in cornell,", messages)
        self.assertIn("in furnace,", messages)
        survey = self.survey()
        self.assertTrue(survey["quick"])
        self.assertEqual([scene["name"] for scene in survey["scenes"]], ["cornell", "furnace"])
        self.assertEqual(survey["scenes"][0], before)
        for scene in survey["scenes"]:
            for technique in scene["techniques"]:
                self.assertGreater(technique["rays"], 0)
                self.assertTrue((self.folder / "out" / technique["image"]).exists())
                self.assertEqual("image_after" in technique, technique["name"] != "path")
        # Other techniques make other conditions.
        messages = self.succeed(*self.COMMAND[:-1], "guide", "--scenes", "furnace", timeout=300).stderr
        self.assertIn("2 scenes were measured under other conditions", messages)
        self.assertEqual([scene["name"] for scene in self.survey()["scenes"]], ["furnace"])

    def test_lists_and_refuses(self):
        listed = self.succeed("survey", "--list").stdout
        self.assertIn("reuse=restir-di", listed)
        self.assertRegex(listed, "scene +mine")
        done = run("survey", "--scenes", "corridr", "-o", "out", cwd=self.folder)
        self.assertEqual(done.returncode, 1)
        self.assertIn("the survey has no scene 'corridr'; did you mean 'corridor'", done.stderr)
        done = run("survey", "--techniques", "cdq", "-o", "out", cwd=self.folder)
        self.assertIn("the survey has no technique 'cdq'", done.stderr)


if __name__ == "__main__":
    unittest.main(defaultTest=sys.argv[1:] or None, argv=sys.argv[:1])
