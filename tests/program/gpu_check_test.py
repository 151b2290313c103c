#!/usr/bin/env python3
"""Tests scripts/gpu_bundle and scripts/gpu_check with few cases: on the processor, and with the stub driver of tests/cuda.
RELUME_STUB_DRIVER_FOLDER is the driver's folder."""

import importlib.machinery
import importlib.util
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
import types
import unittest

from program import PROGRAM, ProgramTest

ROOT = pathlib.Path(__file__).resolve().parents[2]
STUB = os.environ["RELUME_STUB_DRIVER_FOLDER"]
CASES = ["cornell-closed/psf", "cornell/preset interactive", "figure/path"]
ONLY = f"^({'|'.join(CASES)})$"
QUICK = ["--scene", "cornell", "--size", "24x18", "--frames", "1"]


def load(script):
    """The script as a module."""
    loader = importlib.machinery.SourceFileLoader(script, str(ROOT / "scripts" / script))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(script, loader))
    sys.path.insert(0, str(ROOT / "scripts"))
    try:
        loader.exec_module(module)
    finally:
        sys.path.remove(str(ROOT / "scripts"))
    return module


def write_sponza(folder):
    """Writes files as those of Sponza, without content."""
    (folder / "textures").mkdir(parents=True)
    for name in ("sponza.bin", "textures/wall.png", "unused.png"):
        (folder / name).write_text(name)
    inline = {"uri": "data:application/octet-stream;base64,AAAA"}
    (folder / "sponza.gltf").write_text(json.dumps({"buffers": [{"uri": "sponza.bin"}, inline], "images": [{"uri": "textures/wall.png"}, {"bufferView": 0}]}))


def run_script(*command, **options):
    return subprocess.run([sys.executable, *command], capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False, **options)


class Bundled(ProgramTest):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="relume_")
        cls.addClassCleanup(folder.cleanup)
        cls.bundle = pathlib.Path(folder.name) / "bundle"
        scenes = pathlib.Path(folder.name) / "scenes"
        write_sponza(scenes / "sponza")
        made = cls.make(cls.bundle, "--scenes", scenes)
        if made.returncode != 0:
            raise AssertionError(made.stderr)

    @staticmethod
    def make(folder, *arguments, build=PROGRAM, only=ONLY):
        return run_script(ROOT / "scripts/gpu_bundle", folder, "--build", build, "--only", only, *arguments)

    def check(self, *arguments, bundle=None, env=None):
        """Exit code, and the report, of a check."""
        done = run_script((bundle or self.bundle) / "gpu_check", *QUICK, *arguments, "-o", "out", cwd=self.folder, env=env)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        report = json.loads((self.folder / "out/gpu-check.json").read_text())
        self.assertEqual(report["ok"], done.returncode == 0)
        return done.returncode, report

    def check_the_processor(self, techniques):
        """Runs all steps on the processor, and times these techniques."""
        code, report = self.check("--device", "cpu", "--techniques", *techniques)
        self.assertEqual(code, 0, report["steps"])
        self.assertEqual(sorted(report["bits"]["equal"]), CASES)
        self.assertEqual([step["name"] for step in report["steps"]], ["devices", "start", "times", "rays", "bits"])
        self.assertIn("processor", report["devices"]["relume"][0])
        self.assertGreater(report["start"]["second_s"], 0)
        self.assertEqual([row["technique"] for row in report["times"]], techniques)
        self.assertEqual([row["technique"] for row in report["times"][:7]], ["path", "interactive", "bdpt", "bmfr", "psf", "apg", "vlc+cdq"])
        self.assertIn("bmfr-fit", report["times"][3]["passes_ms"])
        for row in report["times"]:
            self.assertEqual(row["frames"], 1)
            self.assertGreater(row["passes_ms"]["trace"], 0, row)
            self.assertLess(row["passes_ms"]["trace"], row["frame_ms"])
            self.assertIsNone(row["memory"]["device"])
        rays = {row["kind"]: row["rays"] for row in report["rays"]}
        self.assertEqual(len(rays), 4)
        self.assertEqual(rays["camera rays"], 24 * 18)
        self.assertGreater(rays["paths of 8 bounces"], rays["shadow rays and first bounces"])
        aims = {row["what"]: row for row in report["aims"]}
        self.assertEqual(list(aims), ["passes cells, resolve of psf", "passes cells, resolve of apg", "passes lights, octree, vlc, cdq of vlc+cdq", "camera rays", "shadow rays and first bounces"])
        for row in report["aims"]:
            self.assertGreater(row["value"], 0, row)
        guided = report["times"][6]
        octree_ms = sum(ms for name, ms in guided["passes_ms"].items() if name.startswith("octree"))
        self.assertGreaterEqual(aims["passes lights, octree, vlc, cdq of vlc+cdq"]["value"], 99.9 * octree_ms / guided["frame_ms"])
        page = (self.folder / "out/gpu-check.html").read_text()
        for part in ("no problem, 3 of 3 cases compared", "<h2>Bits</h2>", "vlc+cdq", "<h2>Slowest passes</h2>", "camera rays", "<h2>Aims"):
            self.assertIn(part, page)


class GpuCheck(Bundled):
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

    def test_a_build_without_device_code_makes_no_bundle(self):
        program = self.folder / "relume"
        program.write_text("#!/bin/sh\necho 'CUDA          no device code in this build; build it with clang'\n")
        program.chmod(0o755)
        made = self.make(self.folder / "bundle", build=program)
        self.assertEqual((made.returncode, self.files()), (1, ["relume"]))
        self.assertIn("no device code", made.stderr)

    def test_sponza_is_copied_with_its_files(self):
        copied = self.bundle / "scenes/sponza"
        self.assertEqual(sorted(str(file.relative_to(copied)) for file in copied.rglob("*") if file.is_file()), ["sponza.bin", "sponza.gltf", "textures/wall.png"])
        self.assertEqual((copied / "textures/wall.png").read_text(), "textures/wall.png")
        # Nothing of a bundle remains whose scene is missing.
        made = self.make(self.folder / "second", "--scenes", self.folder)
        self.assertEqual((made.returncode, self.files()), (1, []))
        self.assertIn("correct --scenes", made.stderr)

    def test_every_choice_is_timed_and_compared(self):
        slots = json.loads((self.bundle / "slots.json").read_text())
        self.assertEqual(list(slots), ["estimator", "lights", "guide", "reuse", "cache", "allocation", "history", "denoise"])
        timed = load("gpu_check").timed_techniques(self.bundle)
        for name in ("light", "vcm", "lights=uniform", "ris", "restir-di", "history=none", "asvgf"):
            self.assertIn(name, timed)
        self.assertEqual(timed["history=none"], ["--history", "none"])
        compared = [settings for settings, _ in load("gpu_bundle").techniques().values()]
        for slot, found in slots.items():
            self.assertIn(found["default"], found["choices"])
            for choice in found["choices"]:
                if choice in ("oidn", found["default"]):
                    continue
                self.assertTrue(any(flags[:2] == [f"--{slot}", choice] for flags in timed.values()), f"{slot} {choice} is not timed")
                self.assertTrue(any(settings.get(slot) == choice for settings in compared), f"{slot} {choice} is not compared")

    def test_a_check_needs_a_bundle(self):
        done = run_script(ROOT / "scripts/gpu_check", cwd=self.folder)
        self.assertEqual((done.returncode, self.files()), (1, []))
        self.assertIn("has no program.tar.gz; run scripts/gpu_bundle", done.stderr)

    def test_the_processor_has_the_bits_of_the_bundle(self):
        # Those with an aim, and choices of three other slots, of which one has settings of its own.
        self.check_the_processor([*load("gpu_check").TIMED, "static-lists", "history=none", "asvgf"])

    def test_the_stub_driver_has_the_bits_of_the_bundle(self):
        environment = {**os.environ, "LD_LIBRARY_PATH": STUB, "RELUME_STUB_DRIVER": "version=12040"}
        # The other steps have limits for a GPU, not for the stub. DeviceBits compares all techniques on the same code.
        code, report = self.check("--only", "figure", "--steps", "devices", "start", "times", "bits", "--techniques", "path", env=environment)
        self.assertEqual(code, 0, report["steps"])
        self.assertEqual([row["technique"] for row in report["times"]], ["path"])
        self.assertEqual(report["bits"]["equal"], ["figure/path"])
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
        for name in ("gpu_check", "gpu_report.py"):
            shutil.copy(self.bundle / name, changed)
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

    def test_a_wrong_number_of_images_is_reported(self):
        changed = self.folder / "changed"
        shutil.copytree(self.bundle, changed)
        cases = json.loads((self.bundle / "bits.json").read_text())[:1]
        cases[0]["images"] = 5
        (changed / "bits.json").write_text(json.dumps(cases))
        code, report = self.check("--device", "cpu", "--steps", "bits", bundle=changed)
        self.assertEqual(code, 1)
        self.assertEqual(report["bits"]["failed"], [{"name": cases[0]["name"], "problem": f"{cases[0]['name']} has 4 images, not 5"}])

    def test_a_check_without_time_is_incomplete(self):
        code, report = self.check("--device", "cpu", "--seconds", "5", "--steps", "bits")
        self.assertEqual(code, 1)
        self.assertEqual(sorted(report["bits"]["not_reached"]), CASES)
        self.assertEqual(report["steps"][0]["problems"], ["no case has equal bits", "1 of 1 cases of the first scene not reached: cornell-closed/psf"])
        self.assertIn("problems, 0 of 3 cases compared", (self.folder / "out/gpu-check.html").read_text())

    def test_a_step_that_exceeds_its_time_is_ended(self):
        # The program of this bundle sleeps.
        slow = self.folder / "slow"
        slow.mkdir()
        for name in ("gpu_check", "gpu_report.py", "bits.json"):
            shutil.copy(self.bundle / name, slow)
        loader = self.folder / "ld-linux-sleep"
        loader.write_text("#!/bin/sh\nexec sleep 100\n")
        loader.chmod(0o755)
        with tarfile.open(slow / "program.tar.gz", "w:gz") as archive:
            archive.add(loader, "lib/ld-linux-sleep")
        code, report = self.check("--device", "cpu", "--seconds", "2.5", "--steps", "start", "times", bundle=slow)
        self.assertEqual(code, 1)
        start, times = report["steps"]
        self.assertRegex(start["problems"][0], "^relume render cornell did not end within [0-9]+ s$")
        self.assertLess(start["seconds"], 50)
        self.assertEqual(times["problems"], ["not run, because the start failed"])

    def test_a_gpu_that_cannot_be_used_ends_the_check(self):
        environment = {**os.environ, "LD_LIBRARY_PATH": STUB, "RELUME_STUB_DRIVER": "capability=61"}
        code, report = self.check("--only", "figure", env=environment)
        self.assertEqual(code, 1)
        self.assertIn("Stub GPU 0, 4.0 GiB, compute capability 6.1", "\n".join(report["devices"]["relume"]))
        problems = {step["name"]: "\n".join(step["problems"]) for step in report["steps"]}
        self.assertEqual(problems.pop("devices"), "")
        self.assertIn("its compute capability is 6.1", problems.pop("start"))
        self.assertEqual(problems, dict.fromkeys(("times", "rays", "bits"), "not run, because the start failed"))

    def test_errors_of_steps_after_the_start_are_reported(self):
        environment = {**os.environ, "LD_LIBRARY_PATH": STUB, "RELUME_STUB_DRIVER": "capability=61"}
        techniques = ["path", "psf", "asvgf"]
        code, report = self.check("--only", "figure", "--steps", "times", "rays", "bits", "--techniques", *techniques, env=environment)
        self.assertEqual(code, 1)
        problems = {step["name"]: "\n".join(step["problems"]) for step in report["steps"]}
        self.assertEqual(problems["times"].count("its compute capability is 6.1"), len(techniques))
        self.assertEqual(problems["rays"].count("its compute capability is 6.1"), 4)
        self.assertIn("its compute capability is 6.1", report["bits"]["failed"][0]["problem"])


class AllTechniques(Bundled):
    def test_every_choice_is_timed_on_the_processor(self):
        self.check_the_processor(list(load("gpu_check").timed_techniques(self.bundle)))


class CasesInTime(unittest.TestCase):
    """Which cases are compared, on a clock that only rendering moves."""

    def compare(self, cases, seconds):
        """Compares cases (name, seconds) within a time. Returns the names not reached, and the problems."""
        module = load("gpu_check")
        now = 0.0

        def hashes(_program, case, *_):
            nonlocal now
            now += case["seconds"]
            return case["hashes"]

        module.time = types.SimpleNamespace(monotonic=lambda: now)
        module.frame_hashes = hashes
        check = object.__new__(module.Check)
        check.cases = [{"name": name, "scene": name.split("/")[0], "seconds": duration, "hashes": ["a"]} for name, duration in cases]
        check.program = types.SimpleNamespace(deadline=seconds)
        check.device, check.folder, check.scenes = "cuda", pathlib.Path(), pathlib.Path()
        problems = []
        return check.bits(problems)["not_reached"], problems

    def test_cases_of_other_scenes_may_be_missing(self):
        cases = [("first/a", 10), ("first/b", 10), ("second/a", 10), ("second/b", 10)]
        self.assertEqual(self.compare(cases, 45), (["second/b"], []))

    def test_cases_of_the_first_scene_may_not_be_missing(self):
        missed, problems = self.compare([("first/a", 10), ("first/b", 10)], 15)
        self.assertEqual(missed, ["first/b"])
        self.assertEqual(problems, ["1 of 2 cases of the first scene not reached: first/b"])

    def test_a_slow_scene_does_not_keep_others_out(self):
        cases = [("first/a", 1), ("slow/a", 30), ("slow/b", 30), ("quick/a", 1), ("quick/b", 1)]
        self.assertEqual(self.compare(cases, 60), (["slow/b"], []))


if __name__ == "__main__":
    unittest.main(defaultTest=sys.argv[1:] or None, argv=sys.argv[:1])
