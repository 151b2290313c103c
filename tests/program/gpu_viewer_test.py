#!/usr/bin/env python3
"""Tests `relume view` on a GPU: the stub driver executes the device code of the library."""

import sys
import unittest

import display
from gpu import environment, launches_in, logging
from viewer_steps import Viewer

SKIPPED = 77  # ctest's exit code for skipped tests
SMALL = ["--width", "48", "--height", "36"]
GPU = [*SMALL, "--device", "cuda"]


class GpuViewer(Viewer):
    def test_frames_of_the_gpu_are_shown(self):
        log = self.folder / "log.txt"
        script = "pace off\nframes 2\nreport\nkey w 5\nset denoise bmfr\nframes 2\nreport\n"
        still, moved, _ = self.view("cornell", script, *GPU, base=logging(log))
        self.assertGreater(len(launches_in(log)), 0)
        self.assertGreater(still["mean_luminance"], 0)
        self.assertGreater(moved["mean_luminance"], 0)
        self.assertNotEqual(still["eye"], moved["eye"])

    def test_the_loss_of_the_gpu_ends_it_and_keeps_bookmarks(self):
        log = self.folder / "log.txt"
        script = "pace off\nframes 1\nkey ctrl+1\nframes 1\n"
        self.view("cornell", script, *GPU, base=logging(log))
        # The script needs no more launches than this, with a margin for a slow interface: the viewer renders all the time.
        later = 6 * len(launches_in(log))
        done = self.run_viewer("cornell", script, *GPU, frames=100000, base=environment(f"lose={later}"))
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("failed in or after the launch of '", done.stderr.splitlines()[-1])
        report = self.view("cornell", "frames 1\nreport\n", *SMALL)[0]
        self.assertEqual(report["bookmarks"], 1)


if __name__ == "__main__":
    if not display.is_available():
        print("neither a display nor Xvfb")
        sys.exit(SKIPPED)
    with display.any_display():
        unittest.main(defaultTest=sys.argv[1:] or None, argv=sys.argv[:1])
