#!/usr/bin/env python3
"""Tests `relume view` in a hidden window: built-in scenes open."""

import sys
import unittest

import display
from program import run
from viewer_steps import Viewer

SKIPPED = 77  # ctest's exit code for skipped tests


class SceneTest(Viewer):
    def check_opens(self, names):
        script = "pace moving\n" + "".join(f"drop {name}\nloaded\nframes 2\nreport\n" for name in names)
        reports = self.view("furnace", script, "--width", 320, "--height", 180)
        self.assertGreaterEqual(len(reports), len(names))
        for name, report in zip(names, reports):
            self.assertEqual(report["scene"], name)
            self.assertGreater(report["mean_luminance"], 0, name)


class AllScenes(SceneTest):
    def test_every_built_in_scene_opens(self):
        names = [line.split()[0] for line in run("scenes").stdout.splitlines() if line.strip()]
        self.assertGreater(len(names), 10)
        self.check_opens(names)


class Scenes(SceneTest):
    def test_scenes_of_each_kind_open(self):
        # A camera path, many lamps, animated objects, and a sky; Input opens city, whose buildings are instances.
        self.check_opens(["cornell-closed", "warehouse", "slit", "mine"])

    def test_screenshot_is_not_black(self):
        self.view("cornell", "frames 4\nscreenshot window.png\n")
        self.assert_shows_something(self.folder / "window.png")


if __name__ == "__main__":
    if not display.is_available():
        print("neither a display nor Xvfb")
        sys.exit(SKIPPED)
    with display.any_display():
        unittest.main(defaultTest=sys.argv[1:] or None, argv=sys.argv[:1])
