#!/usr/bin/env python3
"""Tests which libraries scripts/check_abi compares, with programs in place of the compiler and of abidiff."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77  # ctest's exit code for skipped tests


class CheckAbi(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="relume_")
        self.addCleanup(scratch.cleanup)
        self.root = pathlib.Path(scratch.name)
        (self.root / "scripts").mkdir()
        (self.root / "bin").mkdir()
        shutil.copy(ROOT / "scripts/check_abi", self.root / "scripts")
        self.environment = {**os.environ, "PATH": f"{self.root / 'bin'}:{os.environ['PATH']}", "GIT_CEILING_DIRECTORIES": str(self.root.parent)}
        self.git("init", "--quiet")
        self.commit()
        self.stub("cmake", "exit 0")
        self.stub("abidiff", f'echo "$@" > "{self.root}/compared"')

    def git(self, *arguments):
        command = ["git", "-c", "user.name=Test", "-c", "user.email=test@relume.invalid", *arguments]
        return subprocess.run(command, cwd=self.root, env=self.environment, check=True, capture_output=True, text=True).stdout.strip()

    def commit(self):
        self.git("commit", "--quiet", "--allow-empty", "-m", "empty")
        return self.git("rev-parse", "HEAD")

    def stub(self, name, text):
        program = self.root / "bin" / name
        program.write_text(f"#!/bin/sh\n{text}\n")
        program.chmod(0o755)

    def check(self, *arguments):
        done = subprocess.run([self.root / "scripts/check_abi", *arguments], cwd=self.root, env=self.environment, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        return done.returncode, done.stdout

    def compared(self):
        file = self.root / "compared"
        return file.read_text() if file.exists() else ""

    def test_without_a_tag_it_says_that_it_compares_nothing(self):
        code, output = self.check()
        self.assertEqual(code, 0)
        self.assertIn("nothing was compared", output)
        self.assertIn("--against COMMIT", output)
        self.assertEqual(self.compared(), "")

    def test_the_last_tag_is_the_default(self):
        tagged = self.commit()
        self.git("tag", "v1")
        self.commit()
        code, output = self.check()
        self.assertEqual(code, 0, output)
        self.assertIn("the library of v1", output)
        self.assertIn(f"build/abi/{tagged}/build/src/librelume.so build/abi/this/src/librelume.so", self.compared())

    def test_any_commit_can_be_named(self):
        older = self.git("rev-parse", "HEAD")
        self.commit()
        code, output = self.check("--against", "HEAD~1")
        self.assertEqual(code, 0, output)
        self.assertIn(f"build/abi/{older}/build/src/librelume.so", self.compared())
        self.assertTrue((self.root / f"build/abi/{older}/source/.git").exists(), "the sources of that commit")

    def test_a_break_fails(self):
        self.stub("abidiff", "exit 8")
        code, output = self.check("--against", "HEAD")
        self.assertEqual(code, 8, output)
        self.assertNotIn("run with this one", output)

    def test_wrong_arguments(self):
        for arguments, text in ((("--against", "nowhere"), "no commit 'nowhere'"), (("v1",), "usage:"), (("--against",), "usage:")):
            code, output = self.check(*arguments)
            self.assertEqual(code, 2, output)
            self.assertIn(text, output)
        self.assertEqual(self.compared(), "")


if __name__ == "__main__":
    if not shutil.which("git"):
        print("git is not installed")
        raise SystemExit(SKIPPED)
    unittest.main()
