"""Tests of the search for device code's compiler and lists of kernels, and of builds without device code.
RELUME_CMAKE: the program; RELUME_MODULES: its modules."""

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

    def install(self, name, version, otherwise=""):
        """A compiler that states a version, and runs a line of a shell for all other commands."""
        path = self.folder / name
        states_version = f'if [ "$1" = -dumpversion ]; then echo {version}; exit; fi'
        path.write_text(f"#!/bin/sh\n{states_version}\n{otherwise}\n", encoding="utf-8")
        path.chmod(0o755)

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


class DeviceCode(Script):
    """Builds without a compiler of device code. RelumeDeviceCode.cmake runs as a script, which ends before it compiles."""

    def configure(self, *definitions):
        """Exit code and words of the messages."""
        (self.folder / "src").mkdir(exist_ok=True)
        (self.folder / "src/kernels.inc").touch()
        script = self.folder / "script.cmake"
        modules = os.environ["RELUME_MODULES"]
        script.write_text(
            f"cmake_minimum_required(VERSION 3.25)\nlist(APPEND CMAKE_MODULE_PATH {modules})\n"
            f"set(PROJECT_SOURCE_DIR {self.folder})\nset(PROJECT_BINARY_DIR {self.folder}/build)\n"
            'include(RelumeDeviceCode)\nmessage(STATUS "PTX: [${RELUME_PTX}]")\n',
            encoding="utf-8",
        )
        done = subprocess.run(
            [os.environ["RELUME_CMAKE"], *definitions, "-P", script],
            env={"PATH": str(self.folder)},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        return done.returncode, " ".join(done.stdout.split())

    def assert_note_or_error(self, problem, *definitions):
        """RELUME_CUDA=AUTO builds without device code and states the problem, ON stops, OFF says nothing."""
        self.assertEqual(self.configure(*definitions), (0, f"-- No device code: {problem} -- PTX: []"))
        code, text = self.configure("-DRELUME_CUDA=ON", *definitions)
        self.assertEqual(code, 1)
        self.assertIn(f"RELUME_CUDA=ON, but {problem}; install clang or set RELUME_CUDA=OFF", text)
        self.assertEqual(self.configure("-DRELUME_CUDA=OFF", *definitions), (0, "-- PTX: []"))

    def test_without_clang(self):
        self.assert_note_or_error("clang++ 14 or later is not installed")

    def test_a_clang_that_cannot_compile_device_code(self):
        self.install("clang++", "15.0.6", "echo 'error: no target nvptx64' >&2; echo 'in file probe.cu' >&2; exit 1")
        self.assert_note_or_error(f"{self.folder}/clang++ cannot compile device code: error: no target nvptx64")

    def test_a_clang_that_is_too_old(self):
        self.install("clang++-13", "13.0.1")
        clang = self.folder / "clang++-13"
        self.assert_note_or_error(f"{clang} is not version 14 or later", f"-DRELUME_CLANG={clang}")


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
