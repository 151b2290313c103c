#!/usr/bin/env python3
"""Tests behaviour without free memory or disk space: one message, and no partial files."""

import os
import resource
import struct
import subprocess
import unittest

from program import PROGRAM, ProgramTest

SIZE = ["--width", "200", "--height", "150"]
LARGEST_FILE = 20000  # in bytes, less than every file below


class Limits(ProgramTest):
    def run_limited(self, limit, bytes_, *arguments):
        def apply():  # changes no signals: the program must survive SIGXFSZ on its own
            resource.setrlimit(limit, (bytes_, bytes_))

        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        return subprocess.run([PROGRAM, *arguments], cwd=self.folder, env=environment, preexec_fn=apply, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120, check=False)

    def complaint(self, done):
        self.assertEqual(done.returncode, 1, done.stderr)
        last = done.stderr.replace("\r", "\n").strip().splitlines()[-1].strip()
        self.assertRegex(last, r"^relume: .+; (check|try) ")
        return last

    def written(self):
        """Files, except cached references, which the next run continues."""
        return sorted(p.name for p in self.folder.rglob("*") if p.is_file() and "cache" not in p.parts)

    def test_full_disk(self):
        commands = [
            ["render", "cornell", *SIZE, "--spp", "1", "-o", "a.exr"],
            ["render", "cornell", *SIZE, "--spp", "1", "-o", "a.png"],
            ["render", "cornell", *SIZE, "--spp", "1", "--frames", "0-2", "-o", "a.####.exr"],
            ["render", "cornell", *SIZE, "--spp", "2", "--resume", "a.ckpt", "-o", "a.exr"],
            ["render", "cornell", *SIZE, "--spp", "1", "--aov", "albedo,normal", "-o", "a.exr"],
            ["export", "cornell-spheres", "-o", "a.glb"],
            ["export", "cornell-spheres", "-o", "a.gltf"],
            ["export", "door", "-o", "a.gltf"],
            ["compare", "cornell", *SIZE, "--techniques", "default,u=lights:uniform", "--spp", "1", "--reference-spp", "2", "-o", "page"],
            ["experiment", "run", "guide-cost", "--quick", "-o", "pages"],
            ["man", "-o", "man1"],
        ]
        for command in commands:
            with self.subTest(command=command[:2]):
                last = self.complaint(self.run_limited(resource.RLIMIT_FSIZE, LARGEST_FILE, *command))
                self.assertIn("free space", last)
                self.assertIn("20000 bytes", last)
                self.assertEqual(self.written(), [])

    def test_statistics_that_do_not_fit_leave_the_image(self):
        command = ["render", "cornell", "--width", "8", "--height", "6", "--spp", "1", "--stats", "s.json", "-o", "a.png"]
        last = self.complaint(self.run_limited(resource.RLIMIT_FSIZE, 500, *command))
        self.assertIn("s.json: writing failed", last)
        self.assertIn("free space", last)
        self.assertEqual(self.written(), ["a.png"])

    def test_a_map_that_does_not_fit(self):
        for name, samples in (("a.png", "1"), ("b.png", "2")):
            self.succeed("render", "cornell", *SIZE, "--spp", samples, "-o", name)
        last = self.complaint(self.run_limited(resource.RLIMIT_FSIZE, LARGEST_FILE, "metrics", "a.png", "b.png", "--flip-map", "map.png"))
        self.assertIn("map.png: writing failed", last)
        self.assertIn("free space", last)
        self.assertEqual(self.written(), ["a.png", "b.png"])

    def test_a_checkpoint_that_does_not_fit_leaves_the_image(self):
        command = ["render", "cornell", "--width", "60", "--height", "40", "--spp", "3", "--resume", "a.ckpt", "--checkpoint-interval", "0", "-o", "a.png"]
        last = self.complaint(self.run_limited(resource.RLIMIT_FSIZE, LARGEST_FILE, *command))
        self.assertIn("a.ckpt", last)
        self.assertEqual(self.written(), ["a.png"])

    def test_an_old_image_outlives_a_full_disk(self):
        self.succeed("render", "cornell", *SIZE, "--spp", "1", "-o", "a.exr")
        before = (self.folder / "a.exr").read_bytes()
        self.complaint(self.run_limited(resource.RLIMIT_FSIZE, LARGEST_FILE, "render", "cornell", *SIZE, "--spp", "2", "-o", "a.exr"))
        self.assertEqual((self.folder / "a.exr").read_bytes(), before)

    def test_an_old_scene_outlives_a_full_disk(self):
        self.succeed("export", "cornell", "-o", "a.gltf")
        before = {name: (self.folder / name).read_bytes() for name in self.written()}
        self.assertIn("a.bin", before)
        last = self.complaint(self.run_limited(resource.RLIMIT_FSIZE, LARGEST_FILE, "export", "cornell-spheres", "-o", "a.gltf"))
        self.assertIn("a.bin", last)
        self.assertEqual({name: (self.folder / name).read_bytes() for name in self.written()}, before)

    @unittest.skipIf("RELUME_SANITIZED" in os.environ, "sanitizers take terabytes of addresses")
    def test_out_of_memory(self):
        large = ["--width", "16384", "--height", "16384", "--spp", "1"]
        commands = [  # with MiB of address space; Embree 4 builds the mesh in 700
            (700, ["render", "cornell", *large, "-o", "a.exr"]),
            (700, ["compare", "cornell", *large, "--techniques", "default,u=lights:uniform", "--reference-spp", "2", "-o", "page"]),
            (500, ["render", "large.ply", *SIZE, "--spp", "1", "-o", "a.exr"]),
        ]
        self.write_large_mesh()
        for limit, command in commands:
            with self.subTest(command=command[:2]):
                last = self.complaint(self.run_limited(resource.RLIMIT_AS, limit << 20, *command))
                self.assertIn("memory", last)
                self.assertEqual(self.written(), ["large.ply"])

    def write_large_mesh(self):
        """Writes four million triangles, with all rows coincident."""
        rows = 2000
        vertices = b"".join(struct.pack("<3f", x, y, 0) for y in range(2) for x in range(1001)) * (rows // 2 + 1)
        faces = b"".join(struct.pack("<B3iB3i", 3, x, x + 1, x + 1001, 3, x + 1, x + 1002, x + 1001) for x in range(1000)) * rows
        header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices) // 12}\nproperty float x\nproperty float y\nproperty float z\n"
        header += f"element face {len(faces) // 13}\nproperty list uchar int vertex_indices\nend_header\n"
        (self.folder / "large.ply").write_bytes(header.encode() + vertices + faces)


if __name__ == "__main__":
    unittest.main()
