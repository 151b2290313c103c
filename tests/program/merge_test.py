#!/usr/bin/env python3
"""Tests renders in parts (--sample-range) and their merge."""

import json
import os
import pathlib
import unittest

from program import SMALL, ProgramTest, exr_channels, exr_strings, run

LAYERS = "albedo,normal,depth,motion,variance,heatmap,samples"
LOOK = ["cornell", *SMALL, "--aov", LAYERS]


def channels_of(folder, file):
    """Extremes and means of the channels of an image, without its sums."""
    done = run("info", file, "--json", cwd=folder)
    return [channel for channel in json.loads(done.stdout)["channels"] if not channel["name"].startswith("sums.")]


class Merge(ProgramTest):
    def parts(self, count, *arguments):
        names = [f"part{i}.exr" for i in range(count)]
        for i, name in enumerate(names):
            self.succeed("render", *LOOK, "-o", name, "--sample-range", f"{16 * i}-{16 * i + 15}", *arguments)
        return names

    def refused(self, sentence, *arguments, code=1):
        done = run(*arguments, cwd=self.folder)
        self.assertIn(sentence, done.stderr)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (code, 1), done.stderr)

    def test_parts_in_any_order_are_one_render(self):
        parts = self.parts(4)
        self.succeed("render", *LOOK, "-o", "whole.exr", "--spp", "64")
        done = self.succeed("merge", *reversed(parts), "-o", "merged.exr")
        self.assertIn("wrote merged.exr with 64 samples per pixel", done.stderr)
        self.assertEqual(json.loads(self.succeed("metrics", "merged.exr", "whole.exr", "--json").stdout)["mse"], 0)
        self.assertEqual(channels_of(self.folder, "merged.exr"), channels_of(self.folder, "whole.exr"))
        self.assertEqual(exr_channels(self.folder / "merged.exr"), exr_channels(self.folder / "whole.exr"))
        self.succeed("merge", parts[2], parts[0], parts[3], parts[1], "-o", "again.exr")
        self.assertEqual((self.folder / "again.exr").read_bytes(), (self.folder / "merged.exr").read_bytes())
        texts = exr_strings(self.folder / "merged.exr")
        self.assertEqual((texts["relume.samples"], texts["relume.samples_per_pixel"]), ("0-63", "64"))
        self.assertEqual(json.loads(texts["relume.settings"])["spp"], 64)

    def test_merges_can_be_merged_and_gaps_are_stated(self):
        parts = self.parts(4)
        done = self.succeed("merge", parts[1], parts[3], "-o", "odd.exr", "--keep-sums")
        self.assertIn("with 32 samples per pixel; 32 earlier samples are in no part (16-31,48-63)", done.stderr)
        self.succeed("merge", parts[0], parts[2], "-o", "even.exr")
        self.refused("even.exr: it has no sums of samples", "merge", "odd.exr", "even.exr", "-o", "out.exr")
        self.succeed("merge", parts[0], parts[2], "-o", "even.exr", "--keep-sums")
        self.succeed("merge", "odd.exr", "even.exr", "-o", "out.exr")
        self.succeed("merge", *parts, "-o", "merged.exr")
        self.assertEqual(channels_of(self.folder, "out.exr"), channels_of(self.folder, "merged.exr"))

    def test_what_does_not_belong_together_is_refused(self):
        first, second = self.parts(2)
        self.refused("share samples (0-15 and 0-15)", "merge", first, first, "-o", "out.exr")
        self.succeed("render", *LOOK, "-o", "seed.exr", "--sample-range", "16-31", "--seed", "3")
        self.refused("has seed '0', but", "merge", first, "seed.exr", "-o", "out.exr")
        self.succeed("render", "furnace", *SMALL, "--aov", LAYERS, "-o", "scene.exr", "--sample-range", "16-31")
        self.refused("different scenes", "merge", first, "scene.exr", "-o", "out.exr")
        self.succeed("render", "cornell", *SMALL, "-o", "layers.exr", "--sample-range", "16-31")
        self.refused("different layers", "merge", first, "layers.exr", "-o", "out.exr")
        self.refused("does not exist", "merge", first, "lost.exr", "-o", "out.exr")
        data = (self.folder / second).read_bytes()
        for size in (0, 100, len(data) // 2, len(data) - 1):
            (self.folder / second).write_bytes(data[:size])
            self.refused(second, "merge", first, second, "-o", "out.exr")
        self.assertNotIn("out.exr", self.files())
        self.refused("would replace", "merge", first, "-o", first, code=2)
        self.refused("written as .exr", "merge", first, "-o", "out.png", code=2)
        self.refused("needs -o", "merge", first, code=2)
        self.refused("needs PART", "merge", "-o", "out.exr", code=2)

    def test_ranges_that_cannot_be_parts_are_refused(self):
        def part(sentence, *arguments, output="no.exr"):
            self.refused(sentence, "render", "cornell", *SMALL, "-o", output, *arguments, code=2)

        for text in ("6-15", "16", "31-16", "x", "0-99999999"):
            part(f"--sample-range is '{text}'", "--sample-range", text)
        part("remove --spp", "--sample-range", "0-15", "--spp", "16")
        part("for still images", "--sample-range", "0-15", "--frames", "0-1")
        part("only .exr files", "--sample-range", "0-15", output="no.png")
        part("denoised image", "--sample-range", "0-15", "--denoise", "svgf")
        part("radiance cache", "--sample-range", "0-15", "--cache", "psf")
        part("adaptive sampling", "--sample-range", "0-15", "--allocation", "adaptive")
        part("history 'reproject'", "--sample-range", "0-15", "--history", "reproject")
        part("remove --error", "--sample-range", "0-15", "--error", "0.1")

    def test_a_part_can_be_interrupted_and_resumed(self):
        look = ["render", *LOOK, "--sample-range", "16-47"]
        self.succeed(*look, "-o", "whole.exr")
        self.succeed(*look, "-o", "part.exr", "--resume", "part.ckpt", "--time", "1ms")
        self.assertTrue(exr_strings(self.folder / "part.exr")["relume.samples"].startswith("16-"))
        self.succeed(*look, "-o", "part.exr", "--resume", "part.ckpt")
        self.assertEqual(exr_strings(self.folder / "part.exr")["relume.samples"], "16-47")
        self.assertEqual(channels_of(self.folder, "part.exr"), channels_of(self.folder, "whole.exr"))

    def test_techniques_that_learn_are_independent_renders(self):
        parts = self.parts(2, "--lights", "vlc")
        done = self.succeed("merge", *parts, "-o", "out.exr")
        self.assertIn("with 32 samples per pixel of 2 independent renders", done.stderr)
        self.assertEqual(exr_strings(self.folder / "out.exr")["relume.replicas"], "2")

    def test_names_may_have_commas(self):
        self.succeed("render", *LOOK, "-o", "a,b.exr", "--sample-range", "0-15")
        self.succeed("merge", "a,b.exr", "-o", "out.exr")


@unittest.skipUnless(pathlib.Path("/proc/self/status").exists(), "needs the peak memory of a process")
@unittest.skipIf("RELUME_SANITIZED" in os.environ, "sanitizers keep freed memory")
class Memory(ProgramTest):
    def test_it_does_not_grow_with_the_image(self):
        for name, width, height in (("small", 64, 64), ("large", 64, 4096)):
            size = ["--width", str(width), "--height", str(height)]
            for i in range(2):
                self.succeed("render", "furnace", *size, "-o", f"{name}{i}.exr", "--sample-range", f"{16 * i}-{16 * i}")
        peaks = [self.peak_of_merge(name) for name in ("small", "large")]
        sums = 64 * 4096 * 2 * 80  # bytes of the sums of both large parts
        self.assertLess(peaks[1] - peaks[0], sums / 4)

    def peak_of_merge(self, name):
        pid = os.posix_spawn(os.environ["RELUME_PROGRAM"],
                             ["relume", "merge", "-q", *(str(self.folder / f"{name}{i}.exr") for i in range(2)), "-o", str(self.folder / f"{name}.exr")], os.environ)
        _, status, usage = os.wait4(pid, 0)
        self.assertEqual(status, 0)
        return 1024 * usage.ru_maxrss


if __name__ == "__main__":
    unittest.main()
