#!/usr/bin/env python3
"""Tests compare_pbrt with stand-ins for pbrt: its command line, its reading of images and its arithmetic."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

FOLDER = pathlib.Path(__file__).resolve().parent
PROGRAM = os.environ["RELUME_PROGRAM"]

# A stand-in parses pbrt's arguments. It writes an image of noise about 1; block 1 of the first row has the mean BLOCK.
NOISE = f"""#!{sys.executable}
import argparse, random, sys
sys.path.insert(0, {str(FOLDER)!r})
from shared_images import exr
parser = argparse.ArgumentParser()
parser.add_argument("command", nargs="*")
parser.add_argument("--quiet", action="store_true")
for name in ("--seed", "--spp"):
    parser.add_argument(name, type=int, required=True)
parser.add_argument("--outfile", "-o", required=True)
options = parser.parse_args()
noise = random.Random(1000 * OFFSET + options.seed)
mean = lambda x, y: BLOCK if 16 <= x < 32 and y < 16 else 1
rows = [[(noise.gauss(mean(x, y), 0.1),) * 3 for x in range(48)] for y in range(20)]
open(options.outfile, "wb").write(exr(rows))
"""

# A stand-in that lets relume render, with other seeds; MIRRORED leaves out the line that makes the world right-handed.
RELUME = f"""#!{sys.executable}
import pathlib, subprocess, sys
arguments = dict(zip(sys.argv[2:-1:2], sys.argv[3:-1:2]))
scene = pathlib.Path(sys.argv[-1])
text = scene.read_text().replace("Scale -1 1 1\\n", "") if MIRRORED else scene.read_text()
other = pathlib.Path(arguments["--outfile"]).parent / "other.pbrt"
other.write_text(text)
shared = other.with_name("shared")  # references stay in the scene's folder
if not shared.exists():
    shared.symlink_to(scene.parent / "shared")
sys.exit(subprocess.run([{PROGRAM!r}, "render", other, "--seed", str(1000 + int(arguments["--seed"])), "--spp", arguments["--spp"], "-o", arguments["--outfile"]], capture_output=True).returncode)
"""


class ComparePbrt(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def program(self, name, text, **values):
        file = self.folder / name
        for key, value in values.items():
            text = text.replace(key, str(value))
        file.write_text(text)
        file.chmod(0o755)
        return file

    def compare(self, *arguments):
        command = [sys.executable, str(FOLDER / "compare_pbrt"), *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)

    def test_equal_noise_agrees_and_one_other_block_does_not(self):
        relume = self.program("relume", NOISE, BLOCK=1, OFFSET=1)
        same = self.compare("--pbrt", self.program("pbrt", NOISE, BLOCK=1, OFFSET=2), "--relume", relume, "sun")
        self.assertEqual(same.returncode, 0, same.stderr)
        self.assertRegex(same.stdout, r"sun +(1\.00[0-3]\d|0\.99[7-9]\d) .* agrees")
        # The standard error of a block is 0.1 / 16 / 4 on each side: 0.012 is a Z of 5.4. The limit over 18 tests is 3.45.
        other = self.compare("--pbrt", self.program("pbrt", NOISE, BLOCK=1.012, OFFSET=2), "--relume", relume, "sun")
        self.assertEqual(other.returncode, 1, other.stderr)
        self.assertIn("(limit 3.45)", other.stdout)
        self.assertIn("differs", other.stdout)

    def test_relume_agrees_with_itself_but_not_with_a_mirror_image(self):
        small = ["--rounds", "8", "--spp", "4", "--relume", PROGRAM, "sun"]
        same = self.compare("--pbrt", self.program("pbrt", RELUME, MIRRORED=False), *small)
        self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
        mirrored = self.compare("--pbrt", self.program("pbrt", RELUME, MIRRORED=True), *small)
        self.assertEqual(mirrored.returncode, 1, mirrored.stdout + mirrored.stderr)

    def test_failures_are_reported(self):
        for pbrt, sentence in (("/nowhere/pbrt", "/nowhere/pbrt cannot be started"), ("false", "false failed"), ("true", "true wrote no image")):
            done = self.compare("--pbrt", pbrt, "--relume", PROGRAM, "sun")
            self.assertIn(sentence, done.stderr)
            self.assertEqual(done.returncode, 1)
        for arguments, sentence in ((["moon"], "there is no scene moon"), (["--rounds", "2"], "at least 8")):
            done = self.compare(*arguments)
            self.assertIn(sentence, done.stderr)
            self.assertEqual(done.returncode, 2)
        damaged = self.program("pbrt", "#!/bin/sh\nwhile [ $1 != --outfile ]; do shift; done\necho no image > $2\n")
        self.assertIn("not an EXR", self.compare("--pbrt", damaged, "--relume", PROGRAM, "sun").stderr)


if __name__ == "__main__":
    unittest.main()
