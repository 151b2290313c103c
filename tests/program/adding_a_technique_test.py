#!/usr/bin/env python3
"""Follows docs/adding-a-technique.md literally: writes its files, makes its edits, runs its commands. Without
arguments, stops after the edits."""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/adding-a-technique.md").read_text()


def left_out(folder, names):
    """Names that are excluded from the copy of the sources."""
    at_top = pathlib.Path(folder) == ROOT
    return [n for n in names if n == "__pycache__" or (at_top and (n.startswith("build") or n in (".git", "out")))]


def new_files():
    """Text of new files by path."""
    return {path: text for path, _, text in re.findall(r"^`([^`]+)`:\n\n```(\w+)\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)}


def edits():
    """(path, text before, text after) of every edit."""
    diff = re.search(r"^```diff\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)[1]
    found = []
    for path, places in re.findall(r"^--- a/\S+\n\+\+\+ b/(\S+)\n(.*?)(?=^--- |\Z)", diff, re.MULTILINE | re.DOTALL):
        for place in re.split(r"^@@\n", places, flags=re.MULTILINE)[1:]:
            lines = place.splitlines(keepends=True)
            before = "".join(line[1:] for line in lines if line[0] in " -")
            after = "".join(line[1:] for line in lines if line[0] in " +")
            found.append((path, before, after))
    return found


class Edits(unittest.TestCase):
    def test_they_fit(self):
        self.assertGreater(len(new_files()), 7)
        self.assertGreater(len(edits()), 5)
        self.assertLessEqual(len({path for path, _, _ in edits()}), 4, "places outside its folder that a technique needs")
        for path in new_files():
            self.assertFalse((ROOT / path).exists(), path)
        for path, before, after in edits():
            self.assertEqual((ROOT / path).read_text().count(before), 1, f"{path}: {before}")
            self.assertNotEqual(before, after)


class Building(unittest.TestCase):
    def test_every_step(self):
        with tempfile.TemporaryDirectory(prefix="relume_") as folder:
            tree = pathlib.Path(folder) / "relume"
            shutil.copytree(ROOT, tree, ignore=left_out)
            for path, text in new_files().items():
                (tree / path).parent.mkdir(parents=True, exist_ok=True)
                (tree / path).write_text(text)
            for path, before, after in edits():
                text = (tree / path).read_text()
                self.assertEqual(text.count(before), 1, f"{path}: {before}")
                (tree / path).write_text(text.replace(before, after))
            commands = re.search(r"^```sh\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)[1]
            done = subprocess.run(["bash", "-euxo", "pipefail", "-c", commands], cwd=tree, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stdout[-4000:])
            self.assertGreater((tree / "median.png").stat().st_size, 0)
            self.assertIn("`--median.passes`", (tree / "docs/settings.md").read_text())
            self.assertIn("`denoise=median`", (tree / "docs/combinations.md").read_text())


if __name__ == "__main__":
    unittest.main(defaultTest=sys.argv[1:] or "Edits", argv=sys.argv[:1])
