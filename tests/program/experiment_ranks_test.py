#!/usr/bin/env python3
"""Tests experiments on several ranks, with Open MPI and with MPICH."""

import json
import os
import re
import signal

from ranks import RanksTest, main, rank_process


class Experiments(RanksTest):
    def test_ranks_share_experiments(self):
        names = ["restir-correlation", "bdpt-cost", "psf-variance"]
        names = [name for name in names if name in self.succeed("experiment", "list").stdout]
        self.assertGreater(len(names), 1)
        self.succeed_on_ranks(2, "experiment", "run", *names, "-o", "results", "--quick", "--threads", "1", "--cache-dir", "cache", timeout=900)
        results = sorted(file.name for file in (self.folder / "results").iterdir())
        self.assertEqual(results, sorted(["index.html", "index.md", *(f"{name}{end}" for name in names for end in (".html", ".json"))]))


class DividedExperiments(RanksTest):
    look = ["--quick", "--threads", "1"]

    def run_one(self, name, folder, ranks=None):
        command = ["experiment", "run", name, *self.look, "-o", folder, "--cache-dir", f"{folder}-cache"]
        done = self.succeed_on_ranks(ranks, *command, timeout=900) if ranks else self.succeed(*command, timeout=900)
        self.assertEqual(done.stderr.count(f"wrote {folder}/{name}.html"), 1, done.stderr)
        self.assertEqual(done.stdout.count(f"{name} ["), 1, done.stdout)
        self.assertEqual(sorted(file.name for file in (self.folder / folder).iterdir()), sorted(["index.html", "index.md", f"{name}.html", f"{name}.json"]))
        return json.loads((self.folder / folder / f"{name}.json").read_text())

    def test_results_are_those_of_one_process(self):
        one, two = self.run_one("readapt", "one"), self.run_one("readapt", "two", ranks=2)
        self.assertTrue(two["machine"].pop("Ranks").startswith("2;"))
        self.assertNotIn("Ranks", one["machine"])
        for result in (one, two):
            del result["seconds"]
        self.assertEqual(two, one)
        self.assertFalse(list(self.folder.rglob("*.ckpt")), "checkpoints of references remain")

    def test_claims_about_comparisons_are_those_of_one_process(self):
        one, three = self.run_one("psf-error", "one"), self.run_one("psf-error", "three", ranks=3)
        self.assertGreater(len(one["claims"]), 0)
        self.assertEqual(three["claims"], one["claims"], "none of them is about times")

    def test_times_are_measured(self):
        result = self.run_one("combination", "out", ranks=2)
        self.assertGreater(len(result["curves"]), 0)

    def test_a_current_result_stays(self):
        self.run_one("apg-depth", "out", ranks=2)
        done = self.succeed_on_ranks(2, "experiment", "run", "apg-depth", *self.look, "-o", "out", "--continue")
        self.assertEqual(done.stderr.count("apg-depth is in out already"), 1, done.stderr)

    def test_an_error_is_printed_once(self):
        (self.folder / "scenes/sponza").mkdir(parents=True)
        (self.folder / "scenes/sponza/sponza.gltf").write_text("no glTF")
        done = self.on_ranks(2, "experiment", "run", "bdpt-cost", *self.look, "-o", "out", "--cache-dir", "cache", "--scenes", "scenes")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(len(re.findall(r"^relume: .*sponza.gltf", done.stderr, re.MULTILINE)), 1, done.stderr)
        (self.folder / "foreign").mkdir()
        (self.folder / "foreign/psf-error.json").write_text("{}")
        done = self.on_ranks(2, "experiment", "run", "bdpt-cost", *self.look, "-o", "foreign", "--cache-dir", "cache")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(done.stderr.count("foreign/psf-error.json: this is not the result"), 1, done.stderr)

    def test_a_job_resumes_after_the_loss_of_a_rank(self):
        command = ["experiment", "run", "psf-error", *self.look, "-o", "out", "--cache-dir", "cache"]
        process, mark = self.start_on_ranks(2, *command)
        self.wait_for(lambda: any(self.folder.glob("cache/**/reference-*.exr")), "a reference")
        victim = rank_process(mark, 1)
        self.assertIsNotNone(victim)
        os.kill(victim, signal.SIGKILL)
        self.assertNotEqual(process.wait(60), 0)
        self.assertFalse((self.folder / "out/psf-error.json").exists())
        kept = {file: file.stat().st_mtime_ns for file in self.folder.glob("cache/**/reference-*.exr")}
        self.succeed_on_ranks(2, *command, timeout=900)
        self.assertTrue((self.folder / "out/psf-error.json").exists())
        self.assertEqual({file: file.stat().st_mtime_ns for file in kept}, kept, "references are not rendered again")


class MpichExperiments(Experiments):
    library = "mpich"


class MpichDividedExperiments(DividedExperiments):
    library = "mpich"


if __name__ == "__main__":
    main()
