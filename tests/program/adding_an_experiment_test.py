#!/usr/bin/env python3
"""Compiles the experiment of docs/adding-an-experiment.md, which must follow changes of interfaces."""

import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/adding-an-experiment.md").read_text()
COMPILER = os.environ.get("RELUME_CXX", "c++")


class TheFile(unittest.TestCase):
    def test_compiles(self):
        source = re.search(r"^```cpp\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)[1]
        with tempfile.TemporaryDirectory(prefix="relume_") as name:
            file = pathlib.Path(name) / "filter_error.cpp"
            file.write_text(source)
            # Lanes are vectors: without the flags of the build, GCC warns that their ABI depends on the processor.
            command = [COMPILER, "-std=c++20", "-Wall", "-Wextra", "-Werror", "-Wno-psabi", "-fsyntax-only", *(f"-I{ROOT / folder}" for folder in ("include", "src", "lab")), file]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr[-4000:])


if __name__ == "__main__":
    unittest.main()
