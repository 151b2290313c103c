#!/usr/bin/env python3
"""Follows docs/tutorial.md: runs its commands in order in one shell, and checks their outputs. `Literally` runs them
unchanged, which takes minutes. `Small` uses a sixteenth of the pixels and a tenth of the time."""

import os
import pathlib
import re
import subprocess
import sys
import time
import unittest

from program import PROGRAM, ProgramTest, png_size

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOST_SECONDS = 600  # stated in the tutorial: ten minutes


def commands():
    blocks = re.findall(r"```sh\n(.*?)```", (ROOT / "docs/tutorial.md").read_text(), re.DOTALL)
    return "\n".join(blocks)


def smaller(script):
    """A quarter of every width and height, an eighth of a reference's samples, and a tenth of every time."""
    script = re.sub(r"(--width|--height) (\d+)", lambda m: f"{m[1]} {int(m[2]) // 4}", script)
    script = re.sub(r"--reference-spp (\d+)", lambda m: f"--reference-spp {int(m[1]) // 8}", script)
    return re.sub(r"(--time|--budget) (\d+)s", lambda m: f"{m[1]} {int(m[2]) / 10}s", script)


class Tutorial(ProgramTest):
    def follow(self, script, size):
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        environment["PATH"] = f"{pathlib.Path(PROGRAM).parent}:{environment['PATH']}"
        start = time.monotonic()
        done = subprocess.run(["bash", "-euxo", "pipefail", "-c", script], cwd=self.folder, env=environment, capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=MOST_SECONDS, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        folder = self.folder / "out/tutorial"
        self.assertLess(time.monotonic() - start, MOST_SECONDS)
        for image in ("first.png", "evening.png"):
            self.assertEqual(png_size(folder / image), size)
        for page in ("lights/compare.html", "time/compare.html", "moving/compare.html"):
            self.assertIn("</html>", (folder / page).read_text(), page)


class Literally(Tutorial):
    def test_every_command(self):
        self.follow(commands(), (320, 240))


class Small(Tutorial):
    def test_every_command(self):
        script = commands()
        self.assertGreater(script.count("relume render"), 3)
        self.assertNotEqual(re.findall(r"--budget \S+", script), re.findall(r"--budget \S+", smaller(script)), "no time is shorter")
        self.follow(smaller(script), (80, 60))


if __name__ == "__main__":
    unittest.main(defaultTest=sys.argv[1:] or "Small", argv=sys.argv[:1])
