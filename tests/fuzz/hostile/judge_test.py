#!/usr/bin/env python3
"""Tests that trials detect each forbidden behaviour, with a script in the program's role."""

import pathlib
import sys
import tempfile
import unittest

import judge
import process
from trial_case import Case

CHATTY = "import sys; sys.stderr.write('relume: it failed; try again\\n'); sys.exit(1)"


class Judge(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="relume_hostile_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name) / "case"
        (self.folder / "made").mkdir(parents=True)

    def problems(self, code, wall_s=30, memory_bytes=2 << 30, **case):
        case = Case("test", ["render"], **case)
        for name, data in case.files.items():
            (self.folder / name).write_bytes(data)
        before = judge.snapshot(self.folder)
        texts = [self.folder.parent / name for name in ("out", "err")]
        done = process.run([sys.executable, "-c", code], self.folder, None, *texts, wall_s, memory_bytes)
        return judge.judge(case, done, before, judge.snapshot(self.folder))

    def assert_problem(self, text, code, **options):
        self.assertTrue(any(text in problem for problem in self.problems(code, **options)), text)

    def test_nothing_wrong(self):
        self.assertEqual(self.problems("pass"), [])
        self.assertEqual(self.problems(CHATTY), [])
        self.assertEqual(self.problems("open('made/a', 'w').write('x')", required=["made/a"]), [])

    def test_ends(self):
        self.assert_problem("signal 11", "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
        self.assert_problem("exit code 3", CHATTY.replace("(1)", "(3)"))
        self.assert_problem("must refuse", "pass", refused=True)
        self.assertEqual(self.problems(CHATTY, refused=True), [])
        self.assert_problem("hangs", "import time; time.sleep(60)", wall_s=0.3)

    def test_memory(self):
        hog = "x = bytearray(200 << 20); import time; time.sleep({})"
        self.assert_problem("MiB", hog.format(30), memory_bytes=100 << 20)
        self.assert_problem("MiB", hog.format(0), memory_bytes=100 << 20)
        self.assert_problem("MiB", f"import subprocess, sys; subprocess.run([sys.executable, '-c', '{hog.format(0)}'])", memory_bytes=100 << 20)

    def test_processes(self):
        self.assert_problem("process behind", "import subprocess; subprocess.Popen(['sleep', '30'])")

    def test_texts(self):
        self.assert_problem("one line", "import sys; sys.exit(1)")
        self.assert_problem("one line", CHATTY.replace("failed;", "failed\\n;"))
        self.assert_problem("one line", CHATTY.replace("again", "again\\nrelume: twice"))
        self.assert_problem("std::", CHATTY.replace("it failed", "std::length_error"))
        self.assert_problem("filesystem error", CHATTY.replace("it failed", "filesystem error: status: File name too long [n]"))
        self.assert_problem("control character", CHATTY.replace("it failed", "\\x1b[2J"))
        self.assert_problem("succeeds", CHATTY.replace("(1)", "(0)"))

    def test_files(self):
        write = "open({!r}, 'w').write('x'); "
        self.assert_problem("left 'made/a'", write.format("made/a") + CHATTY)
        self.assert_problem("changed 'in'", write.format("in") + CHATTY, files={"in": b"input"})
        self.assert_problem("replaced the input 'in'", write.format("in"), files={"in": b"input"}, may_change=["i*"])
        self.assertEqual(self.problems(write.format("in"), files={"in": b"input"}, may_change=["in"]), [])
        self.assert_problem("deleted 'in'", "import os; os.remove('in')", files={"in": b"input"})
        self.assert_problem("temporary file", write.format("made/.a.1.tmp.exr"))
        self.assert_problem("not a declared output", write.format("elsewhere"))
        self.assert_problem("wrote nothing", "open('made/a', 'w')")
        self.assert_problem("without 'made/a'", "pass", required=["made/a"])


if __name__ == "__main__":
    unittest.main()
