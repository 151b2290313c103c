#!/usr/bin/env python3
"""Tests what the program says about GPUs, with the stub driver of tests/cuda in place of NVIDIA's."""

import unittest

from gpu import STUB, environment
from program import SMALL, ProgramTest, run


class Devices(ProgramTest):
    def listed(self, folder, settings=""):
        """Lines of `relume devices` about CUDA."""
        result = run("devices", env=environment(settings, folder))
        self.assertEqual(result.returncode, 0)
        return [line for line in result.stdout.splitlines() if line.lower().startswith("cuda")]

    def refusal(self, folder, settings, *arguments):
        """The sentence of a rendering that fails."""
        result = run("render", "cornell", "-o", "out.png", *SMALL, "--spp", "1", *arguments, cwd=self.folder, env=environment(settings, folder))
        self.assertNotEqual(result.returncode, 0)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertFalse((self.folder / "out.png").exists())
        return result.stderr

    def damaged_driver(self):
        """A folder with a file in place of the driver, which hides one that the system may have."""
        (self.folder / "libcuda.so.1").touch()
        return self.folder

    def test_devices_lists_gpus_and_why_one_cannot_be_used(self):
        lines = self.listed(STUB, "devices=2 version=12040")
        self.assertEqual(len(lines), 3)
        self.assertEqual(lines[0], "CUDA          12.4; relume has not been tested on a GPU yet")
        self.assertEqual(lines[2], "cuda:1        Stub GPU 1, 4.0 GiB, compute capability 9.0")
        self.assertIn("; cannot be used: its compute capability is 6.1", self.listed(STUB, "capability=61")[1])

    def test_devices_says_why_there_is_no_gpu(self):
        self.assertIn("no CUDA driver", self.listed(self.damaged_driver())[0])
        self.assertIn("supports CUDA 9.2, but relume needs 10.0", self.listed(STUB, "version=9020")[0])

    def test_a_gpu_that_is_named_must_be_usable(self):
        self.assertIn("no CUDA driver", self.refusal(self.damaged_driver(), "", "--device", "cuda"))
        self.assertIn("the CUDA driver finds no GPU", self.refusal(STUB, "devices=0", "--device", "cuda"))
        self.assertIn("there is no GPU 3", self.refusal(STUB, "", "--device", "cuda:3"))
        self.assertIn("compute capability is 6.1", self.refusal(STUB, "capability=61", "--device", "cuda:0"))
        self.assertIn("--device is 'gpu'", self.refusal(STUB, "", "--device", "gpu"))

    def test_without_a_usable_gpu_auto_renders_on_the_host(self):
        for device in ("auto", "cpu"):
            result = run("render", "cornell", "-o", "out.png", *SMALL, "--spp", "1", "--device", device, cwd=self.folder, env=environment("capability=61"))
            self.assertEqual(result.returncode, 0, result.stderr)


if __name__ == "__main__":
    unittest.main()
