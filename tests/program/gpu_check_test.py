#!/usr/bin/env python3
"""Tests scripts/gpu_bundle and scripts/gpu_check with few cases: on the processor, and with the stub driver of tests/cuda.
RELUME_STUB_DRIVER_FOLDER is the driver's folder."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest

from program import PROGRAM, ProgramTest

ROOT = pathlib.Path(__file__).resolve().parents[2]
STUB = os.environ["RELUME_STUB_DRIVER_FOLDER"]
CASES = ["cornell-closed/psf", "cornell/preset interactive", "figure/path"]
ONLY = f"^({'|'.join(CASES)})$"
QUICK = ["--scene", "cornell", "--size", "24x18", "--frames", "1"]


class GpuCheck(ProgramTest):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="relume_")
        cls.addClassCleanup(folder.cleanup)
        cls.bundle = pathlib.Path(folder.name) / "bundle"
        made = cls.make(cls.bundle)
        if made.returncode != 0:
            raise AssertionError(made.stderr)

    @staticmethod
    def make(folder):
        return subprocess.run([sys.executable, ROOT / "scripts/gpu_bundle", folder, "--build", PROGRAM, "--only", ONLY], capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)

    def check(self, *arguments, bundle=None, env=None):
        """Exit code, and the report, of a check."""
        done = subprocess.run([sys.executable, (bundle or self.bundle) / "gpu_check", *QUICK, *arguments, "-o", "out"], cwd=self.folder, env=env, capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        report = json.loads((self.folder / "out/gpu-check.json").read_text())
        self.assertEqual(report["ok"], done.returncode == 0)
        return done.returncode, report

    def test_a_bundle_has_all_libraries(self):
        with tarfile.open(self.bundle / "program.tar.gz") as archive:
            names = archive.getnames()
            archive.extractall(self.folder)
        self.assertIn("lib/libdl.so.2", names)
        self.assertFalse([name for name in names if "libcuda" in name or "libnvidia" in name])
        loader = next((self.folder / "lib").glob("ld-linux*"))
        listed = subprocess.run([loader, "--library-path", self.folder / "lib", "--list", self.folder / "bin/relume"], capture_output=True, text=True, check=True).stdout
        places = [line.split(" => ")[1] for line in listed.splitlines() if " => " in line]
        self.assertGreater(len(places), 5)
        self.assertFalse([place for place in places if not place.startswith(f"{self.folder}/lib/")])
        self.assertLess(sum(file.stat().st_size for file in self.bundle.rglob("*")), 60_000_000)

    def test_a_bundle_replaces_no_folder(self):
        made = self.make(self.folder)
        self.assertEqual((made.returncode, self.files()), (1, []))
        self.assertIn("exists; remove it", made.stderr)

    def test_the_processor_has_the_bits_of_the_bundle(self):
        code, report = self.check("--device", "cpu")
        self.assertEqual(code, 0, report["steps"])
        self.assertEqual(sorted(report["bits"]["equal"]), CASES)
        self.assertEqual([step["name"] for step in report["steps"]], ["devices", "start", "times", "rays", "bits"])
        self.assertIn("processor", report["devices"]["relume"][0])
        self.assertGreater(report["start"]["second_s"], 0)
        self.assertEqual([row["technique"] for row in report["times"]], ["path", "interactive", "bdpt", "bmfr", "psf", "apg", "vlc+cdq"])
        for row in report["times"]:
            self.assertEqual(row["frames"], 1)
            self.assertGreater(row["passes_ms"]["trace"], 0)
            self.assertLess(row["passes_ms"]["trace"], row["frame_ms"])
            self.assertIsNone(row["memory"]["device"])
        rays = {row["kind"]: row["rays"] for row in report["rays"]}
        self.assertEqual(len(rays), 4)
        self.assertEqual(rays["camera rays"], 24 * 18)
        self.assertGreater(rays["paths of 8 bounces"], rays["shadow rays and first bounces"])
        page = (self.folder / "out/gpu-check.html").read_text()
        for part in ("no problem", "<h2>Bits</h2>", "vlc+cdq", "<h2>Slowest passes</h2>", "camera rays"):
            self.assertIn(part, page)

    def test_the_stub_driver_has_the_bits_of_the_bundle(self):
        environment = {**os.environ, "LD_LIBRARY_PATH": STUB, "RELUME_STUB_DRIVER": "version=12040"}
        code, report = self.check("--only", "psf|figure", env=environment)
        self.assertEqual(code, 0, report["steps"])
        self.assertEqual(sorted(report["bits"]["equal"]), ["cornell-closed/psf", "figure/path"])
        for row in report["times"]:
            device = row["memory"]["device"]
            self.assertEqual((device["name"], device["driver"]), ("Stub GPU 0 (cuda:0)", "12.4"))
            self.assertGreater(device["memory_used_bytes"], 0)
            self.assertLess(device["memory_used_bytes"], device["memory_limit_bytes"])
            self.assertLess(device["memory_limit_bytes"], device["memory_bytes"])
        self.assertIn("Stub GPU 0", (self.folder / "out/gpu-check.html").read_text())

    def test_different_bits_are_reported(self):
        changed = self.folder / "changed"
        changed.mkdir()
        shutil.copy(self.bundle / "gpu_check", changed)
        for name in ("program.tar.gz", "scenes"):
            (changed / name).symlink_to(self.bundle / name)
        cases = json.loads((self.bundle / "bits.json").read_text())
        self.assertEqual([len(set(case["hashes"])) for case in cases], [4, 4, 4])
        cases[0]["hashes"][2] = cases[0]["hashes"][1]
        (changed / "bits.json").write_text(json.dumps(cases))
        code, report = self.check("--device", "cpu", "--steps", "bits", "--only", "cornell", bundle=changed)
        self.assertEqual(code, 1)
        self.assertEqual(report["bits"]["different"], [{"name": cases[0]["name"], "first_frame": 2, "equals_processor_here": True, "processor_here_equals_bundle": False}])
        self.assertEqual(report["bits"]["equal"], [cases[1]["name"]])
        self.assertIn(f"1 of 2 cases different: {cases[0]['name']}", report["steps"][0]["problems"])

    def test_all_steps_report_a_gpu_that_cannot_be_used(self):
        environment = {**os.environ, "LD_LIBRARY_PATH": STUB, "RELUME_STUB_DRIVER": "capability=61"}
        code, report = self.check("--only", "figure", env=environment)
        self.assertEqual(code, 1)
        self.assertIn("Stub GPU 0, 4.0 GiB, compute capability 6.1", "\n".join(report["devices"]["relume"]))
        problems = {step["name"]: "\n".join(step["problems"]) for step in report["steps"]}
        self.assertEqual(problems.pop("devices"), "")
        self.assertEqual(sorted(problems), ["bits", "rays", "start", "times"])
        for name, problem in problems.items():
            self.assertNotEqual(problem, "", name)
        self.assertIn("its compute capability is 6.1", report["bits"]["failed"][0]["problem"])
        self.assertEqual(problems["times"].count("its compute capability is 6.1"), 7)


if __name__ == "__main__":
    unittest.main()
