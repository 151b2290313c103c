#!/usr/bin/env python3
"""Follows docs/embedding.md: builds and runs its programs with the installed package."""

import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["RELUME_BUILD"])
PAGE = (ROOT / "docs/embedding.md").read_text()

# Both libraries consist of the same objects: compiling once tests the headers.
PROJECT = """cmake_minimum_required(VERSION 3.25)
project(embedding LANGUAGES CXX)
{package}
# Compiles the headers once for all programs.
file(WRITE ${{CMAKE_BINARY_DIR}}/headers.cpp "")
add_library(headers OBJECT ${{CMAKE_BINARY_DIR}}/headers.cpp)
target_link_libraries(headers PRIVATE relume::relume)
target_precompile_headers(headers PRIVATE <relume/relume.h>)
foreach(program {programs})
  add_executable(${{program}} ${{program}}.cpp)
  {link}
  target_precompile_headers(${{program}} REUSE_FROM headers)
  add_executable(${{program}}_shared $<TARGET_OBJECTS:${{program}}>)
  target_link_libraries(${{program}}_shared PRIVATE relume::shared)
endforeach()
add_executable(measure measure.cpp)
target_link_libraries(measure PRIVATE relume::lab)
target_precompile_headers(measure REUSE_FROM headers)
"""


# One program, with the package's given components.
SINGLE = """cmake_minimum_required(VERSION 3.25)
project(single LANGUAGES CXX)
find_package(relume REQUIRED {components})
add_executable(single {source})
target_link_libraries(single PRIVATE relume::shared)
"""


def run(*command, cwd=None):
    done = subprocess.run([str(part) for part in command], cwd=cwd, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    return done.returncode, done.stdout


class Embedding(unittest.TestCase):
    def succeed(self, *command, cwd=None):
        code, output = run(*command, cwd=cwd)
        self.assertEqual(code, 0, output[-4000:])
        return output

    def test_every_program(self):
        programs = dict(re.findall(r"^```cpp\n// (\w+)\.cpp\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL))
        self.assertEqual(sorted(programs), ["editor", "frame_loop", "measure", "offline"])
        package, link = re.search(r"^```cmake\n(.*)\n(.*)\n```", PAGE, re.MULTILINE).groups()
        with tempfile.TemporaryDirectory(prefix="relume_") as name:
            folder = pathlib.Path(name)
            for component in ("library", "shared", "lab"):
                self.succeed("cmake", "--install", BUILD, "--prefix", folder / "prefix", "--component", component)
            installed = {file.name for file in (folder / "prefix/include").rglob("*.h")}
            self.assertEqual(installed, {file.name for folder in ("include", "lab/include") for file in (ROOT / folder).rglob("*.h")})
            project = folder / "project"
            project.mkdir()
            for program, text in programs.items():
                self.assertIn("#include <relume/relume.h>", text, "which is precompiled here")
                (project / f"{program}.cpp").write_text(text)
            linked = link.replace("program", "${program}")
            embedding = " ".join(sorted(programs.keys() - {"measure"}))
            (project / "CMakeLists.txt").write_text(PROJECT.format(package=package, link=linked, programs=embedding))
            flags = [f"-DCMAKE_PREFIX_PATH={folder / 'prefix'}", f"-DCMAKE_CXX_COMPILER={os.environ['RELUME_CXX']}", f"-DCMAKE_CXX_FLAGS={os.environ.get('RELUME_CXX_FLAGS', '')}"]
            self.succeed("cmake", "-S", project, "-B", project / "build", *flags)
            self.succeed("cmake", "--build", project / "build")
            scene = folder / "room.glb"
            self.succeed(os.environ["RELUME_PROGRAM"], "export", "cornell", "-o", scene)
            for ending in ("", "_shared"):
                with self.subTest(ending=ending):
                    self.run_programs(project / "build", ending, scene)
            self.assertIn("tree: MSE", self.succeed(project / "build/measure", scene, cwd=project))

    def test_the_shared_library_needs_no_packages_of_the_static_one(self):
        packages = re.findall(r"^ *find_package\((\w+)", (ROOT / "cmake/RelumeDependencies.cmake").read_text(), re.MULTILINE)
        self.assertIn("TBB", packages)
        with tempfile.TemporaryDirectory(prefix="relume_") as name:
            folder = pathlib.Path(name)
            flags = [f"-DCMAKE_PREFIX_PATH={folder / 'prefix'}", f"-DCMAKE_CXX_COMPILER={os.environ['RELUME_CXX']}", f"-DCMAKE_CXX_FLAGS={os.environ.get('RELUME_CXX_FLAGS', '')}"]
            flags += [f"-DCMAKE_DISABLE_FIND_PACKAGE_{package}=ON" for package in packages]

            def install(component):
                self.succeed("cmake", "--install", BUILD, "--prefix", folder / "prefix", "--component", component)

            # One build folder, in which CMake tests the compiler once.
            def configure(components):
                (folder / "CMakeLists.txt").write_text(SINGLE.format(components=components, source=ROOT / "tests/package/main.cpp"))
                code, output = run("cmake", "-S", folder, "-B", folder / "build", *flags)
                return code, " ".join(output.split())

            install("shared")
            code, output = configure("COMPONENTS shared")
            self.assertEqual(code, 0, output)
            self.succeed("cmake", "--build", folder / "build")
            self.succeed(folder / "build/single", cwd=folder)
            code, output = configure("")
            self.assertNotEqual(code, 0)
            self.assertIn("use find_package(relume COMPONENTS shared)", output)
            # The static library does need them, so the first program could fail.
            install("library")
            for components in ("", "COMPONENTS static", "COMPONENTS lab"):
                code, output = configure(components)
                self.assertNotEqual(code, 0, components)
                self.assertIn("CMAKE_DISABLE_FIND_PACKAGE", output)

    def run_programs(self, build, ending, scene):
        self.assertIn("pixels are lit", self.succeed(build / f"frame_loop{ending}", scene))
        self.assertIn("was removed", self.succeed(build / f"editor{ending}", scene))
        image = build / f"room{ending}.png"
        output = self.succeed(build / f"offline{ending}", scene, image)
        self.assertRegex(output, "ended by: (interrupted|error)")
        self.assertGreater(image.stat().st_size, 0)
        code, output = run(build / f"offline{ending}", build / "missing.glb", build / "none.png")
        self.assertEqual(code, 2, output)
        self.assertIn("missing.glb", output)


if __name__ == "__main__":
    unittest.main()
