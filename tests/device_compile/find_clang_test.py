"""Tests of the search for device code's compiler and lists of kernels. RELUME_CMAKE: the program; RELUME_MODULES: its
modules."""

import os
import pathlib
import subprocess
import tempfile
import unittest


class Script(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def output_of(self, module, commands, *definitions):
        """The message `[...]` of a script that includes a module, with the folder as search path."""
        script = self.folder / "script.cmake"
        script.write_text(f"include({os.environ['RELUME_MODULES']}/{module}.cmake)\n{commands}\n", encoding="utf-8")
        done = subprocess.run(
            [os.environ["RELUME_CMAKE"], *definitions, "-P", script],
            env={"PATH": str(self.folder)},
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stderr[done.stderr.index("[") + 1 : done.stderr.index("]")]


class FindClang(Script):
    def install(self, name, version):
        path = self.folder / name
        path.write_text(f"#!/bin/sh\necho {version}\n", encoding="utf-8")
        path.chmod(0o755)

    def found(self, *definitions):
        return self.output_of("RelumeFindClang", 'relume_find_clang(CLANG)\nmessage("[${CLANG}]")', *definitions)

    def test_an_old_compiler_does_not_hide_a_newer_one(self):
        self.install("clang++", "13.0.1")
        self.install("clang++-15", "15.0.6")
        self.assertEqual(self.found(), str(self.folder / "clang++-15"))

    def test_the_plain_name_comes_first(self):
        self.install("clang++", "14.0.6")
        self.install("clang++-17", "17.0.1")
        self.assertEqual(self.found(), str(self.folder / "clang++"))

    def test_old_compilers_are_not_used(self):
        self.install("clang++", "13.0.1")
        self.assertEqual(self.found(), "CLANG-NOTFOUND")

    def test_the_users_choice_is_kept(self):
        self.install("clang++", "14.0.6")
        self.assertEqual(self.found("-DCLANG=/opt/clang++"), "/opt/clang++")


class KernelLists(Script):
    def test_lists_are_found_at_any_depth(self):
        lists = ["kernels.inc", "scene/kernels.inc", "techniques/a/b/c/kernels.inc"]
        for name in lists:
            (self.folder / "src" / name).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / "src" / name).touch()
        commands = f'relume_find_kernel_lists({self.folder}/src lists)\nmessage("[${{lists}}]")'
        self.assertEqual(sorted(self.output_of("RelumeKernelLists", commands).split(";")), sorted(lists))


if __name__ == "__main__":
    unittest.main()
