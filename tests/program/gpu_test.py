#!/usr/bin/env python3
"""Tests whole programs on a GPU: the stub driver executes the device code of the library. Images have the bits of the host, and
after errors of the GPU, everything that was finished is kept."""

import json
import os
import sys
import unittest

from gpu import environment, launches_in, logging
from program import ProgramTest, exr_pixels, exr_strings, run

# Two tiles: the stub takes many times longer for a pixel than the host.
WIDTH, HEIGHT = 18, 10
SIZE = ["--width", str(WIDTH), "--height", str(HEIGHT), "--threads", "1"]
GPU = ["--device", "cuda"]
HOST = ["--device", "cpu", "--accel", "bvh"]
LOST = "failed in or after the launch of '"
NO_MEMORY = "CUDA_ERROR_OUT_OF_MEMORY"
# Without graphs, each launch of a kernel is a call of the driver.
NO_GRAPHS = {**os.environ, "RELUME_CUDA_GRAPHS": "0"}


class GpuTest(ProgramTest):
    def render(self, *arguments):
        return self.succeed("render", *arguments, *SIZE, env=environment())

    def last_path_launch(self, *arguments, base=os.environ):
        """The number of the last launch that traces paths, counted from 1. Files of the command are removed."""
        before = self.files()
        log = self.folder / "log.txt"
        self.succeed(*arguments, env=logging(log, base=base))
        launches = launches_in(log)
        for name in set(self.files()) - set(before):
            (self.folder / name).unlink()
        return max(number for number, name in enumerate(launches, 1) if "PathKernel" in name)

    def assert_fails(self, *arguments, settings, sentence, before=(), base=os.environ):
        """Runs a command that fails with one sentence, after these lines."""
        done = run(*arguments, cwd=self.folder, env=environment(settings, base=base))
        self.assertEqual(done.returncode, 1, done.stderr)
        *lines, last = done.stderr.splitlines()
        self.assertEqual(lines, list(before))
        self.assertIn(sentence, last)
        self.assertIn("; ", last, "a remedy")

    def assert_equal_bits(self, a, b):
        self.assertEqual(exr_pixels(self.folder / a), exr_pixels(self.folder / b), (a, b))


class Images(GpuTest):
    def test_an_image_has_the_bits_of_the_host(self):
        image = ["cornell", "--spp", "3", "--aov", "albedo,depth,variance"]
        self.render(*image, "-o", "gpu.exr", *GPU)
        self.render(*image, "-o", "host.exr", *HOST)
        self.assert_equal_bits("gpu.exr", "host.exr")
        self.assertEqual(json.loads(exr_strings(self.folder / "gpu.exr")["relume.settings"])["device"], "cuda")

    def test_a_sequence_has_the_bits_of_the_host(self):
        sequence = ["turntable", "--frames", "0-2", "--spp", "1", "--history", "reproject", "--denoise", "svgf", "--lights", "light-tree"]
        self.render(*sequence, "-o", "gpu.####.exr", *GPU)
        self.render(*sequence, "-o", "host.####.exr", *HOST)
        for frame in range(3):
            self.assert_equal_bits(f"gpu.{frame:04}.exr", f"host.{frame:04}.exr")

    def test_auto_takes_a_gpu_that_can_be_used(self):
        log = self.folder / "log.txt"
        for settings, uses_gpu in (("", True), ("capability=61", False), ("devices=0", False), ("version=9020", False)):
            self.succeed("render", "cornell", *SIZE, "--spp", "1", "-o", "auto.exr", "--device", "auto", env=logging(log, settings))
            self.assertEqual(len(launches_in(log)) > 0, uses_gpu, settings)

    def test_graphs_of_launches_change_no_bits(self):
        image = ["render", "cornell", *SIZE, "--spp", "8", "--history", "reproject", "--denoise", "svgf", *GPU, "-o"]
        self.succeed(*image, "graphs.exr", env=environment())
        self.succeed(*image, "single.exr", env=environment(base=NO_GRAPHS))
        self.succeed(*image, "refused.exr", env=environment("fail=cuGraphLaunch:3:2"))
        self.assert_equal_bits("graphs.exr", "single.exr")
        self.assert_equal_bits("graphs.exr", "refused.exr")
        done = run(*image, "other.exr", cwd=self.folder, env=environment(base={**os.environ, "RELUME_CUDA_GRAPHS": "yes"}))
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("RELUME_CUDA_GRAPHS is 'yes', but must be 0", done.stderr)

    def test_statistics_have_times_and_memory(self):
        self.render("cornell", "--spp", "2", "-o", "gpu.exr", *GPU, "--stats", "gpu.json")
        self.render("cornell", "--spp", "2", "-o", "host.exr", *HOST, "--stats", "host.json")
        gpu, host = (json.loads((self.folder / f"{name}.json").read_text()) for name in ("gpu", "host"))
        self.assertEqual(gpu["device"]["name"], "Stub GPU 0 (cuda:0)")
        self.assertGreater(gpu["device"]["memory_used_bytes"], 0)
        self.assertIsNone(host["device"])
        for count in ("samples", "paths", "rays", "buffer_bytes"):
            self.assertEqual(gpu[count], host[count], count)
        self.assertGreater(gpu["scene_bytes"], 0)
        # The stub's clock counts 1 µs per thread.
        trace = next(entry for entry in gpu["passes"] if entry["name"] == "trace")
        self.assertGreaterEqual(trace["seconds"], 2 * WIDTH * HEIGHT * 1e-6)

    def test_comparisons_have_the_numbers_of_the_host(self):
        for name, device in (("gpu", GPU), ("host", HOST)):
            self.succeed("compare", "cornell", *SIZE, "--techniques", "plain=lights:power,reused=history:accumulate", "--spp", "1", "--repeat", "2",
                         "--reference-spp", "4", "--cache-dir", "cache", "-o", name, *device, env=environment())
        gpu, host = (json.loads((self.folder / name / "compare.json").read_text()) for name in ("gpu", "host"))
        self.assertEqual(gpu["reference"]["settings"]["device"], "cuda")
        self.assertEqual([contender["settings"]["device"] for contender in gpu["contenders"]], ["cuda", "cuda"])
        for a, b in zip(gpu["contenders"], host["contenders"]):
            self.assertEqual(a["mse"], b["mse"], a["name"])


class Experiments(GpuTest):
    def test_an_experiment_runs_on_the_gpu_and_records_it(self):
        log = self.folder / "log.txt"
        command = ["experiment", "run", "guide-cost", "--quick", "--threads", "1", "--cache-dir", "cache", "-o", "out"]
        self.succeed(*command, *GPU, env=logging(log), timeout=1200)
        self.assertGreater(len(launches_in(log)), 0)
        result = json.loads((self.folder / "out/guide-cost.json").read_text())
        self.assertEqual(result["device"], "cuda")
        self.assertTrue(result["machine"]["Device"].startswith("Stub GPU 0 (cuda:0), driver for CUDA "), result["machine"])
        index = (self.folder / "out/index.md").read_text()
        self.assertIn("Device: Stub GPU 0 (cuda:0)", index)
        self.assertEqual(index.count("Device: "), 1, "neither the processor nor the option")
        self.assertIn("guide-cost is in out already", self.succeed(*command, *GPU, "--continue", env=environment()).stderr)
        self.assertNotIn("already", self.succeed(*command, "--continue", env=environment(), timeout=600).stderr, "the host has no result")


class Errors(GpuTest):
    def test_a_driver_that_is_too_old_leaves_no_file(self):
        command = ["render", "turntable", *SIZE, "--frames", "0-1", "--spp", "1", "-o", "f.####.exr", *GPU]
        self.assert_fails(*command, settings="version=9020", sentence="the CUDA driver supports CUDA 9.2, but relume needs 10.0")
        self.assertEqual(self.files(), [])
        self.assert_fails("experiment", "run", "guide-cost", "--quick", "-o", "out", "--cache-dir", "cache", *GPU, settings="version=9020",
                          sentence="the CUDA driver supports CUDA 9.2, but relume needs 10.0")
        self.assertEqual(run("experiment", "run", "guide-cost", "--device", "gpu", "-o", "out", cwd=self.folder).returncode, 1)

    def test_a_gpu_without_memory_leaves_no_file(self):
        self.assert_fails("render", "cornell", *SIZE, "--spp", "1", "-o", "a.exr", *GPU, settings="memory=256", sentence="has no room for")
        self.assertEqual(self.files(), [])

    def test_frames_that_are_finished_are_kept(self):
        sequence = ["render", "turntable", *SIZE, "--spp", "1", "--history", "reproject", "--quiet", *GPU]
        output = ["-o", "f.####.exr"]
        in_third = self.last_path_launch(*sequence, *output, "--frames", "0-2")
        self.succeed(*sequence, "-o", "whole.####.exr", "--frames", "0-2", env=environment())
        complete = self.files()
        for settings, sentence, base in ((f"lose={in_third}", LOST, os.environ), (f"fail=cuLaunchKernel:{in_third}:2", NO_MEMORY, NO_GRAPHS)):
            with self.subTest(settings):
                self.assert_fails(*sequence, *output, "--frames", "0-3", settings=settings, sentence=sentence, base=base)
                self.assertEqual(self.files(), sorted(["f.0000.exr", "f.0001.exr", *complete]))
                for frame in range(2):
                    self.assert_equal_bits(f"f.{frame:04}.exr", f"whole.{frame:04}.exr")
                    (self.folder / f"f.{frame:04}.exr").unlink()

    def test_a_video_keeps_its_finished_frames(self):
        # The fake encoder stores the raw frames.
        base = self.with_encoder('for last; do :; done; cat > "$last"')
        film = ["render", "turntable", *SIZE, "--spp", "1", *GPU, "-o", "film.mp4", "--frames"]
        in_third = self.last_path_launch(*film, "0-2", base=base)
        done = run(*film, "0-3", cwd=self.folder, env=environment(f"lose={in_third}", base=base))
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("film.mp4 ends with frame 1", done.stderr)
        self.assertIn(LOST, done.stderr.splitlines()[-1])
        self.assertEqual((self.folder / "film.mp4").stat().st_size, 2 * WIDTH * HEIGHT * 3)
        self.assertEqual(self.files(), ["bin", "film.mp4"])

    def test_an_image_is_kept_as_of_the_last_checkpoint_interval(self):
        image = ["render", "cornell", *SIZE, *GPU, "-o", "a.exr", "--checkpoint-interval"]
        in_fifth = self.last_path_launch(*image, "0", "--spp", "5")
        lost = f"lose={in_fifth}"
        self.assert_fails(*image, "60", "--spp", "8", settings=lost, sentence=LOST)
        self.assertEqual(self.files(), [], "the interval has not passed")
        self.assert_fails(*image, "0", "--spp", "8", settings=lost, sentence=LOST, before=["the GPU failed; wrote a.exr with 4 samples per pixel"])
        self.assertEqual(self.files(), ["a.exr"])
        self.assertEqual(exr_strings(self.folder / "a.exr")["relume.samples_per_pixel"], "4")
        self.render("cornell", "--spp", "4", "-o", "host.exr", *HOST)
        self.assert_equal_bits("a.exr", "host.exr")

    def test_an_image_is_kept_where_memory_runs_out(self):
        image = ["render", "cornell", *SIZE, *GPU, "-o", "a.exr"]
        in_fifth = self.last_path_launch(*image, "--spp", "5")
        self.assert_fails(*image, "--spp", "8", settings=f"fail=cuLaunchKernel:{in_fifth}:2", sentence=NO_MEMORY, base=NO_GRAPHS,
                  before=["the GPU failed; wrote a.exr with 4 samples per pixel"])
        self.render("cornell", "--spp", "4", "-o", "host.exr", *HOST)
        self.assert_equal_bits("a.exr", "host.exr")

    def test_a_checkpoint_continues_on_the_host(self):
        image = ["render", "cornell", *SIZE, "--quiet", "--resume", "a.ckpt", "--checkpoint-interval", "0", "-o", "a.exr"]
        in_fifth = self.last_path_launch(*image, *GPU, "--spp", "5")
        self.assert_fails(*image, *GPU, "--spp", "8", settings=f"lose={in_fifth}", sentence=LOST)
        self.assertEqual(self.files(), ["a.ckpt", "a.exr"])
        done = self.render("cornell", "--resume", "a.ckpt", "-o", "a.exr", "--spp", "8", *HOST)
        self.assertIn("continues from a.ckpt at 4 samples per pixel", done.stderr)
        self.render("cornell", "--spp", "8", "-o", "host.exr", *HOST)
        self.assert_equal_bits("a.exr", "host.exr")

    def test_a_finished_reference_is_kept(self):
        comparison = ["compare", "cornell", *SIZE, "--techniques", "plain=lights:power", "--spp", "1", "--repeat", "1", "--reference-spp", "4", *GPU]
        log = self.folder / "log.txt"
        self.succeed(*comparison, "--cache-dir", "other", "-o", "whole", env=logging(log))
        in_contender = max(number for number, name in enumerate(launches_in(log), 1) if "PathKernel" in name)
        comparison += ["--cache-dir", "cache"]
        done = run(*comparison, "-o", "lost", cwd=self.folder, env=environment(f"lose={in_contender}"))
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(LOST, done.stderr.splitlines()[-1])
        self.succeed(*comparison, "-o", "again", env=environment())
        for name, cached in (("whole", False), ("again", True)):
            self.assertEqual(json.loads((self.folder / name / "compare.json").read_text())["reference"]["cached"], cached, name)


if __name__ == "__main__":
    unittest.main(defaultTest=sys.argv[1:] or None, argv=sys.argv[:1])
