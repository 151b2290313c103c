#!/usr/bin/env python3
"""The program as its users meet it: exit codes, files, streams, interruption. Argument: the program."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = os.path.abspath(sys.argv.pop(1))
SMALL = ["--width", "48", "--height", "32"]


def relume(*arguments, code=0):
    """Runs the program; its standard output, or standard error if it is to fail."""
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=120, check=False)
    if done.returncode != code:
        raise AssertionError(f"relume {' '.join(arguments)}: exit code {done.returncode}, not {code}\n{done.stdout}{done.stderr}")
    return done.stdout if code == 0 else done.stderr


def contents(file):
    with open(file, "rb") as stream:
        return stream.read()


class Program(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)

    def test_writes_what_was_asked_for(self):
        out = relume("render", "cornell", "-o", "a.png", "--spp", "2", "--stats", "s.json", *SMALL)
        self.assertEqual(out, "", "results alone go to standard output")
        self.assertTrue(contents("a.png").startswith(b"\x89PNG"))
        with open("s.json", encoding="utf-8") as stream:
            stats = json.load(stream)
        self.assertEqual(stats["samples"], 48 * 32 * 2)
        self.assertGreater(stats["rays"], stats["paths"])
        self.assertGreater(stats["peak_memory_bytes"], 1 << 20)
        self.assertTrue(all(entry["seconds"] >= 0 for entry in stats["passes"]))

    def test_refuses_in_one_sentence_and_writes_nothing(self):
        for code, arguments in (
            (2, ["rendr"]),
            (2, ["render", "cornell", "-o", "a.png", "--widht", "3"]),
            (2, ["render", "cornell", "-o", "a.png", "--width", "0"]),
            (2, ["render", "cornell", "-o", "a.xyz"]),
            (2, ["render", "cornell", "-o", "nowhere/a.png"]),
            (2, ["render", "cornell", "-o", "a.png", "--aov", "albedo"]),
            (1, ["render", "cornel", "-o", "a.png"]),
            (1, ["render", "cornell", "-o", "a.png", "--preset", "none"]),
            (1, ["render", "cornell", "-o", "a.png", "--camera", "none"]),
            (1, ["render", "cornell", "-o", "a.png", "--env", "1,2"]),
            (1, ["render", "cornell", "-o", "a.png", "--settings", "missing.json"]),
        ):
            message = relume(*arguments, code=code)
            self.assertEqual(message.count("\n"), 1, message)
            self.assertTrue(message.startswith("relume: "), message)
        self.assertEqual(os.listdir(), [])

    def test_threads_do_not_change_the_picture(self):
        for threads in ("1", "2"):
            relume("render", "cornell", "-o", f"{threads}.hdr", "--spp", "3", "--threads", threads, *SMALL)
        self.assertEqual(contents("1.hdr"), contents("2.hdr"))

    def test_a_picture_can_be_made_again_from_its_own_settings(self):
        relume("render", "cornell", "-o", "a.exr", "--spp", "2", "--seed", "7", "--max-bounces", "2", *SMALL)
        relume("render", "cornell", "-o", "b.exr", "--settings", "a.exr")
        metrics = json.loads(relume("metrics", "a.exr", "b.exr", "--json"))
        self.assertEqual(metrics["mse"], 0)
        self.assertEqual(metrics["mean_a"], metrics["mean_b"])
        self.assertIn('"seed": 7', relume("info", "b.exr"))

    def test_layers_have_their_names(self):
        relume("render", "cornell", "-o", "a.exr", "--spp", "2", "--aov", "albedo,depth,variance", *SMALL)
        info = relume("info", "a.exr")
        for channel in ("R", "albedo.G", "depth.Z", "variance.Y"):
            self.assertIn(f" {channel} from ", info)

    def test_frames_of_an_animation_differ(self):
        relume("render", "turntable", "-o", "f.hdr", "--frames", "3-4", "--fps", "4", "--spp", "1", *SMALL)
        self.assertEqual(sorted(os.listdir()), ["f.0003.hdr", "f.0004.hdr"])
        self.assertNotEqual(contents("f.0003.hdr"), contents("f.0004.hdr"))

    def test_resumes_after_kill_with_the_same_bits(self):
        render = ["render", "cornell", "-o", "a.hdr", "--resume", "a.ckpt", *SMALL]
        process = subprocess.Popen([PROGRAM, *render, "--spp", "1000000", "--checkpoint-interval", "0", "-q"])
        deadline = time.monotonic() + 60
        while not os.path.exists("a.ckpt") and time.monotonic() < deadline:
            time.sleep(0.01)
        process.kill()
        process.wait()
        relume(*render, "--spp", "1", "--stats", "s.json")  # finds out how far it had come
        with open("s.json", encoding="utf-8") as stream:
            wanted = json.load(stream)["samples_per_pixel"] + 2
        relume(*render, "--spp", str(wanted))
        relume("render", "cornell", "-o", "whole.hdr", "--spp", str(wanted), *SMALL)
        self.assertEqual(contents("a.hdr"), contents("whole.hdr"))

    def test_interruption_writes_what_there_is(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            command = [PROGRAM, "render", "cornell", "-o", "a.png", "--spp", "1000000", "--resume", f"{number}.ckpt",
                       "--checkpoint-interval", "0", *SMALL]
            with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
                deadline = time.monotonic() + 60
                while not os.path.exists(f"{number}.ckpt") and time.monotonic() < deadline:
                    time.sleep(0.01)
                process.send_signal(number)
                message = process.communicate(timeout=60)[1]
                self.assertEqual(process.returncode, 130)
            self.assertIn("interrupted; wrote a.png", message)
            self.assertTrue(contents("a.png").startswith(b"\x89PNG"))
            os.remove("a.png")

    def test_a_full_disk_is_a_failure(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            self.assertEqual(subprocess.run([PROGRAM, "scenes"], stdout=full, stderr=subprocess.DEVNULL, check=False).returncode, 1)

    def test_exports_what_it_can_read_again(self):
        relume("export", "cornell", "-o", "c.glb", "-q")
        self.assertEqual(relume("info", "c.glb").split("triangles")[1].split("\n")[0],
                         relume("info", "cornell").split("triangles")[1].split("\n")[0])

    def test_every_command_explains_itself(self):
        for command in ("render", "scenes", "export", "info", "metrics", "settings", "devices", "completion"):
            text = relume(command, "--help")
            self.assertLess(text.index("Examples:"), text.index("Usage:"))


if __name__ == "__main__":
    unittest.main()
