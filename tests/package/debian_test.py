#!/usr/bin/env python3
"""Tests the Debian packages made by cpack, and their desktop data. RELUME_BUILD is the build folder.
scripts/test_package installs the packages in a bare system."""

import functools
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SKIPPED = 77  # ctest's exit code for skipped tests
TOOLS = ("cpack", "dpkg-deb", "dpkg-shlibdeps", "file", "lintian", "desktop-file-validate", "update-mime-database", "rsvg-convert")
MISSING = [tool for tool in TOOLS if not shutil.which(tool)]
BUILD = pathlib.Path(os.environ["RELUME_BUILD"])
ROOT = pathlib.Path(__file__).resolve().parents[2]
EPOCH = "1700000000"
DESKTOP = ROOT / "apps" / "relume" / "desktop"


def run(*command, **options):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, check=True, **options).stdout


def pack(folder, **environment):
    """Package files by name. Uses gzip instead of xz, which takes ten times longer."""
    run("cpack", "--config", BUILD / "CPackConfig.cmake", "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip", "-B", folder, cwd=folder, env={**os.environ, "SOURCE_DATE_EPOCH": EPOCH, **environment})
    return {file.name.split("_")[0]: file for file in sorted(folder.glob("*.deb"))}


def field(package, name):
    return run("dpkg-deb", "-f", package, name).strip()


@functools.cache
def contents(package):
    """(mode, owner) by path, without folders."""
    lines = [line.split(None, 5) for line in run("dpkg-deb", "-c", package).splitlines()]
    return {line[5][1:]: (line[0], line[1]) for line in lines if not line[0].startswith("d")}


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="relume_")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.packages = pack(pathlib.Path(cls.folder.name))
        cls.program = cls.packages["relume"]
        cls.library = cls.packages["librelume-dev"]
        cls.python = cls.packages.get("python3-relume")

    def test_names_and_dependencies(self):
        architecture = run("dpkg", "--print-architecture").strip()
        for name, package in self.packages.items():
            self.assertEqual(package.name, f"{name}_{field(package, 'Version')}_{architecture}.deb")
        needed = re.findall(r"(?:^|, )([\w.+-]+)", field(self.program, "Depends"))
        for library in ("libc6", "libstdc++6", "libtbb12"):
            self.assertIn(library, needed)
        installed = (ROOT / "scripts/install_packages").read_text().replace("pkg-config", "pkgconf")  # the older name
        for package in field(self.library, "Depends").split(", "):
            self.assertRegex(installed, rf"(?m)[ ]{re.escape(package)}( |$)", "relume is not built with it")

    def test_the_program_brings_its_data(self):
        files = contents(self.program)
        for file in ("bin/relume", "share/man/man1/relume.1.gz", "share/bash-completion/completions/relume", "share/zsh/vendor-completions/_relume",
                     "share/fish/vendor_completions.d/relume.fish", "share/mime/packages/relume.xml", "share/doc/relume/copyright", "share/doc/relume/changelog.gz"):
            self.assertIn(f"/usr/{file}", files)
        commands = re.findall(r"^  (\w+) ", run(BUILD / "bin/relume", "--help").split("Commands:")[1].split("Options:")[0], re.MULTILINE)
        pages = [file for file in files if file.startswith("/usr/share/man/man1/relume-")]
        self.assertEqual(pages, sorted(f"/usr/share/man/man1/relume-{command}.1.gz" for command in commands))
        self.assertFalse([file for file in files if file.endswith((".h", ".a", ".cmake"))])

    def test_the_library_brings_headers_and_its_cmake_package(self):
        files = contents(self.library)
        for ending in ("/librelume.a", "/relume/relumeConfig.cmake", "/relume/session.h", "/librelume-dev/copyright"):
            self.assertTrue(any(file.endswith(ending) for file in files), ending)
        self.assertFalse([file for file in files if "/bin/" in file or "/testing/" in file])

    def test_the_python_package_brings_module_and_types(self):
        if self.python is None:
            self.skipTest("the build has no Python package")
        files = contents(self.python)
        folder = "/usr/lib/python3/dist-packages/relume"
        for file in ("__init__.py", "_core.pyi", "py.typed", "metrics.py"):
            self.assertIn(f"{folder}/{file}", files)
        self.assertEqual(len([file for file in files if file.startswith(f"{folder}/_core.cpython-")]), 1)
        self.assertFalse([file for file in files if "__pycache__" in file])
        self.assertRegex(field(self.python, "Depends"), r"python3 \(>= 3\.\d+\), python3 \(<< 3\.\d+\), python3-numpy")

    def test_modes_and_owners(self):
        for package in self.packages.values():
            for file, (mode, owner) in contents(package).items():
                expected = "-rwxr-xr-x" if "/bin/" in file else "-rw-r--r--"
                self.assertEqual((mode, owner), (expected, "root/root"), file)

    def test_installing_refuses_processors_that_lack_the_instructions(self):
        script = (ROOT / "cmake/debian/preinst").read_text()
        for flags, status in (("sse2 avx avx2", 0), ("sse2 avx avx512f", 1)):
            with tempfile.NamedTemporaryFile("w", prefix="relume_") as processor:
                processor.write(f"flags\t\t: fpu {flags}\n")
                processor.flush()
                done = subprocess.run(["sh", "-c", script.replace("/proc/cpuinfo", processor.name)], capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, "AVX2" in done.stderr), (status, status == 1), flags)

    def test_lintian_finds_no_fault_in_the_program(self):
        self.lint(self.program, *filter(None, [self.python]))

    def lint(self, *packages):
        done = subprocess.run(["lintian", "--no-cfg", "--allow-root", "--fail-on", "error,warning", *packages], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)


class Library(Packages):
    """Slow: lintian reads every object file of the static library, and all packages are made again."""

    def test_the_same_files_make_the_same_packages(self):
        with tempfile.TemporaryDirectory(prefix="relume_") as folder:
            again = pack(pathlib.Path(folder), TZ="Asia/Tokyo", LC_ALL="C")
            for name, package in again.items():
                self.assertEqual(package.read_bytes(), self.packages[name].read_bytes(), name)

    def test_lintian_finds_no_fault_in_the_library(self):
        self.lint(self.library)


class Configuration(unittest.TestCase):
    """Package settings of other builds, configured without a compiler."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="relume_")
        self.addCleanup(folder.cleanup)
        self.source = pathlib.Path(folder.name)
        self.config = self.source / "build/CPackConfig.cmake"
        (self.source / "CMakeLists.txt").write_text(
            f"cmake_minimum_required(VERSION 3.25)\nproject(relume VERSION 1.2.3 LANGUAGES NONE)\n"
            f"set(RELUME_VERSION_DATE 2026-01-01)\ninclude({ROOT}/cmake/RelumePackage.cmake)\n"
        )

    def configured(self, *definitions):
        """Values of CPACK_ variables by name."""
        run("cmake", "--fresh", "-S", self.source, "-B", self.source / "build", *definitions)
        return dict(re.findall(r'^set\((CPACK_\w+) "(.*?)"\)$', self.config.read_text(), re.MULTILINE | re.DOTALL))

    def test_only_builds_for_avx2_ask_for_it(self):
        for arch, note, preinst in (
            ("x86-64-v3", "needs a processor with AVX2", True),
            ("x86-64-v4", "needs a processor with AVX2", True),
            ("native", "is for the processor of the machine", False),
            ("x86-64", None, False),
            ("x86-64-v2", None, False),
            ("armv8-a", None, False),
            ("", None, False),
        ):
            with self.subTest(arch=arch):
                found = self.configured(f"-DRELUME_ARCH={arch}")
                for package in ("PROGRAM", "LIBRARY"):
                    description = found[f"CPACK_DEBIAN_{package}_DESCRIPTION"]
                    self.assertIn(note or "", description)
                    self.assertEqual("This build" in description, note is not None, description)
                self.assertEqual("CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA" in found, preinst)

    def test_cross_compiled_packages_name_the_target(self):
        name = "CPACK_DEBIAN_PACKAGE_ARCHITECTURE"
        for processor, architecture in (("aarch64", "arm64"), ("x86_64", "amd64"), ("riscv64", "riscv64")):
            found = self.configured("-DCMAKE_SYSTEM_NAME=Linux", f"-DCMAKE_SYSTEM_PROCESSOR={processor}")
            self.assertEqual(found[name], architecture)
        self.assertNotIn(name, self.configured(), "CPack asks dpkg")

    def test_builds_with_openimagedenoise_are_refused(self):
        self.configured("-DOpenImageDenoise_FOUND=ON")
        done = subprocess.run(["cpack", "--config", self.config], cwd=self.source, capture_output=True, text=True, check=False)
        self.assertNotEqual(done.returncode, 0, done.stdout)
        self.assertIn("CMAKE_DISABLE_FIND_PACKAGE_OpenImageDenoise", done.stderr)
        self.assertFalse([*self.source.glob("*.deb")])


class DesktopData(unittest.TestCase):
    def test_the_desktop_entry_is_valid(self):
        self.assertEqual(run("desktop-file-validate", DESKTOP / "relume.desktop"), "")

    def test_file_types_are_recognised_by_name_and_content(self):
        with tempfile.TemporaryDirectory(prefix="relume_") as folder:
            types = pathlib.Path(folder) / "mime"
            (types / "packages").mkdir(parents=True)
            shutil.copy(DESKTOP / "relume.xml", types / "packages")
            done = subprocess.run(["update-mime-database", types], env={**os.environ, "XDG_DATA_DIRS": folder}, capture_output=True, text=True, check=True)
            self.assertEqual(done.stdout + done.stderr, "")
            globs = (types / "globs").read_text().splitlines()
            self.assertEqual({line for line in globs if not line.startswith("#")}, {"model/gltf-binary:*.glb", "model/gltf+json:*.gltf"})
            self.assertIn(b"model/gltf-binary]\n>0=\0\x04glTF", (types / "magic").read_bytes())

    def test_the_desktop_entry_lists_all_file_types(self):
        entry = (DESKTOP / "relume.desktop").read_text()
        types = re.search(r"^MimeType=(.*);$", entry, re.MULTILINE)[1].split(";")
        for name in re.findall(r'<mime-type type="([^"]+)"', (DESKTOP / "relume.xml").read_text()):
            self.assertIn(name, types)

    def test_the_icon_can_be_drawn_at_every_size(self):
        for size in (16, 48, 512):
            drawn = subprocess.run(["rsvg-convert", "-w", str(size), "-h", str(size), DESKTOP / "relume.svg"], capture_output=True, check=True).stdout
            self.assertEqual(int.from_bytes(drawn[16:20], "big"), size)


if __name__ == "__main__":
    if MISSING:
        print(f"{', '.join(MISSING)} not installed; scripts/install_packages installs them")
        sys.exit(SKIPPED)
    unittest.main(defaultTest=sys.argv[1:] or ["Packages", "Configuration", "DesktopData"], argv=sys.argv[:1])
