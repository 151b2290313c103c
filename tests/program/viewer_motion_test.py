#!/usr/bin/env python3
"""Tests `relume view` in a hidden window: camera motion and animated scenes."""

import sys
import unittest

import display
from viewer_steps import Viewer, animated_gltf, cube_ply, dot, length

SKIPPED = 77  # ctest's exit code for skipped tests


class Camera(Viewer):
    def test_keys_fly_and_the_mouse_turns(self):
        script = "frames 1\nreport\nkey w 20\nframes 2\nreport\nkey shift+d 10\nframes 2\nreport\ndrag 0.5 0.5 0.7 0.4\nframes 2\nreport\nkey home\nframes 2\nreport\n"
        start, forward, side, turned, home, _ = self.view("cornell", script)
        # The distances depend on how long frames take.
        flown = [b - a for a, b in zip(start["eye"], forward["eye"])]
        aside = [b - a for a, b in zip(forward["eye"], side["eye"])]
        self.assertGreater(length(flown), 0.01)
        self.assertGreater(dot(flown, start["forward"]), 0.999 * length(flown))
        self.assertGreater(length(aside), 0.01)
        self.assertLess(abs(dot(aside, start["forward"])), 0.001 * length(aside))
        self.assertGreater(max(abs(a - b) for a, b in zip(side["forward"], turned["forward"])), 0.05)
        self.assertEqual(side["forward"], forward["forward"])
        for a, b in zip(start["eye"], home["eye"]):
            self.assertAlmostEqual(a, b, places=4)

    def test_objects_are_orbited_and_framed(self):
        (self.folder / "cube.ply").write_text(cube_ply(1))
        script = ("frames 1\nreport\ndrag 0.5 0.5 0.7 0.4\nframes 1\nreport\nmouse 0.5 0.5\nwheel 3\nframes 1\nreport\n"
                  "drag 0.5 0.5 0.7 0.5 shift\nframes 1\nreport\nkey f\nframes 1\nreport\nkey o\nwheel 3\nframes 1\nreport\n")
        start, turned, near, aside, framed, flying, _ = self.view("cube.ply", script)
        self.assertTrue(start["orbits"])
        self.assertGreater(length([a - b for a, b in zip(start["eye"], turned["eye"])]), 0.5)
        self.assertAlmostEqual(length(start["eye"]), length(turned["eye"]), delta=0.01 * length(start["eye"]))
        self.assertLess(length(near["eye"]), 0.8 * length(turned["eye"]))
        self.assertLess(length([a - b for a, b in zip(aside["forward"], near["forward"])]), 1e-5)
        self.assertGreater(length([a - b for a, b in zip(aside["eye"], near["eye"])]), 0.1)
        self.assertLess(length([a - b for a, b in zip(framed["forward"], aside["forward"])]), 1e-5)
        self.assertAlmostEqual(length(framed["eye"]), length(start["eye"]), delta=0.3 * length(start["eye"]))
        self.assertFalse(flying["orbits"])
        self.assertEqual(flying["eye"], framed["eye"], "the wheel changes the speed")

    def test_the_orbit_keeps_the_pivot_that_was_framed_while_flying(self):
        (self.folder / "cube.ply").write_text(cube_ply(1))
        script = ("frames 1\nkey o\ndrag 0.5 0.5 0.6 0.5\nframes 1\nkey f\nframes 1\nkey o\nframes 1\nreport\n"
                  "drag 0.5 0.5 0.7 0.4\nframes 1\nreport\n")
        framed, turned, _ = self.view("cube.ply", script)
        self.assertTrue(framed["orbits"])
        self.assertGreater(length([a - b for a, b in zip(framed["eye"], turned["eye"])]), 0.5)
        self.assertAlmostEqual(length(framed["eye"]), length(turned["eye"]), delta=1e-3 * length(framed["eye"]))

    def test_a_held_key_flies_no_further_than_frames_show(self):
        # Slow frames, each limited to a step of 0.15 s.
        script = "pace off\nset width 700\nset height 500\nset max-bounces 12\nframes 1\nreport\nkey w 60\nreport\nframes 1\nreport\nseconds 1\nreport\n"
        start, held, shown, later, _ = self.view("cornell", script)
        flown = length([a - b for a, b in zip(start["eye"], held["eye"])])
        steps = held["frames"] - start["frames"] + 1
        self.assertLessEqual(steps, 5, "so few frames that their number limits the flight")
        self.assertGreater(flown, 0)
        self.assertLessEqual(flown, 0.15 * 1.01 * steps * start["speed"])
        self.assertEqual(shown["eye"], held["eye"], "the key was released")
        self.assertEqual(later["eye"], held["eye"])


class Models(Viewer):
    def test_a_model_plays_at_once_and_lists_its_clips(self):
        (self.folder / "sail.gltf").write_text(animated_gltf())
        script = ("frames 1\nreport\nseconds 1\nframes 1\nreport\npanel scene\nset animation rise\nframes 1\nreport\n"
                  "try animation sing\nreport\nkey p\nframes 1\nreport\nseconds 0.5\nreport\n")
        first, later, rising, refused, stopped, still, _ = self.view("sail.gltf", script)
        self.assertEqual(first["clips"], ["turn", "rise"])
        self.assertTrue(first["animating"])
        self.assertGreater(later["time_s"], first["time_s"] + 0.3)
        self.assertAlmostEqual(first["animation_s"], 20, places=4)
        self.assertAlmostEqual(rising["animation_s"], 3, places=4)
        self.assertTrue(any("'turn', 'rise'" in message for message in refused["messages"]), refused["messages"])
        self.assertAlmostEqual(refused["animation_s"], 3, places=4)
        self.assertFalse(stopped["animating"])
        self.assertEqual(still["time_s"], stopped["time_s"])


if __name__ == "__main__":
    if not display.is_available():
        print("neither a display nor Xvfb")
        sys.exit(SKIPPED)
    with display.any_display():
        unittest.main(defaultTest=sys.argv[1:] or None, argv=sys.argv[:1])
