#!/usr/bin/env python3
"""Tests time and memory for large scenes and large images."""

import json
import sys
import unittest

from program import ProgramTest

GIB = 1 << 30


class Scale(ProgramTest):
    def stats(self, *arguments):
        self.succeed("render", *arguments, "-o", "out.exr", "--spp", "1", "--stats", "s.json", "--quiet", timeout=550)
        stats = json.loads((self.folder / "s.json").read_text())
        print(f"{arguments}: load {stats['load_s']:.2f} s, build {stats['build_s']:.2f} s, render {stats['render_s']:.2f} s, "
              f"{stats['peak_memory_bytes'] / GIB:.2f} GiB", file=sys.stderr)
        self.assertEqual(stats["nonfinite_samples"], 0)
        return stats

    def test_ten_million_instanced_triangles(self):
        stats = self.stats("city", "--width", "160", "--height", "90")
        self.assertLess(stats["load_s"] + stats["build_s"], 10)
        self.assertLess(stats["peak_memory_bytes"], 4 * GIB)

    def test_ten_million_instanced_triangles_with_the_own_bvh(self):
        stats = self.stats("city", "--accel", "bvh", "--width", "160", "--height", "90")
        self.assertLess(stats["load_s"] + stats["build_s"], 10)
        self.assertLess(stats["peak_memory_bytes"], 2e9)

    def test_8k_image(self):
        stats = self.stats("cornell", "--width", "7680", "--height", "4320")
        # Six float planes for the sums, and as many for image and file: 33 million pixels below 120 bytes each.
        self.assertLess(stats["peak_memory_bytes"], 4 * GIB)


if __name__ == "__main__":
    unittest.main()
