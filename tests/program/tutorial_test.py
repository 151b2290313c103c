#!/usr/bin/env python3
"""Follows docs/tutorial.md literally: runs its commands in order, in one shell, and looks at what they write."""

import os
import pathlib
import re
import subprocess
import time
import unittest

from program import PROGRAM, ProgramTest, png_size

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOST_SECONDS = 600  # it promises ten minutes


class Tutorial(ProgramTest):
    def test_every_command(self):
        blocks = re.findall(r"```sh\n(.*?)```", (ROOT / "docs/tutorial.md").read_text(), re.DOTALL)
        self.assertGreater(len(blocks), 5)
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        environment["PATH"] = f"{pathlib.Path(PROGRAM).parent}:{environment['PATH']}"
        start = time.monotonic()
        script = ["bash", "-euxo", "pipefail", "-c", "\n".join(blocks)]
        done = subprocess.run(script, cwd=self.folder, env=environment, capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=MOST_SECONDS, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        folder = self.folder / "out/tutorial"
        self.assertLess(time.monotonic() - start, MOST_SECONDS)
        for picture in ("first.png", "evening.png"):
            self.assertEqual(png_size(folder / picture), (320, 240))
        for page in ("lights/compare.html", "adaptive/compare.html", "moving/compare.html"):
            self.assertIn("</html>", (folder / page).read_text(), page)


if __name__ == "__main__":
    unittest.main()
