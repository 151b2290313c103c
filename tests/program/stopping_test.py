#!/usr/bin/env python3
"""Tests the end of a render: samples, time, error, interruption, kill -9 and resumption."""

import contextlib
import json
import os
import pathlib
import re
import resource
import signal
import sys
import time
import unittest

from program import SMALL, ProgramTest, exr_strings, png_size, run, start

# Allows for busy machines: an idle one answers in 0.1 s. Without checks for interrupts, it took at least ten seconds.
SECONDS_TO_ANSWER = 20 if "RELUME_SANITIZED" in os.environ else 4
SECONDS_IN_SILENCE = 3 if "RELUME_SANITIZED" in os.environ else 0.3  # slower answers must report their remaining work
SECONDS_OF_STEPS = 6 if "RELUME_SANITIZED" in os.environ else 1  # where every step can be stopped, reported or not
ATTEMPTS = 3  # a busy machine is slow occasionally, a command without checks always
ROOM = ["cornell", "--width", "96", "--height", "96"]
LAYERS = ["--aov", "heatmap,variance"]
LISTS = ["--lights", "static-lists", "--static-lists.rays", "65536"]  # take seconds to prepare


def cpu_seconds(pid):
    """Processor time that a running process has used."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def cpu_seconds_of_ended_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class StoppingTest(ProgramTest):
    def stats(self):
        return json.loads((self.folder / "s.json").read_text())

    def wait_for(self, file, process, seconds=60):
        """Waits until `file` exists, with the process still running."""
        end = time.monotonic() + seconds
        while not file.exists() and time.monotonic() < end:
            time.sleep(0.01)
        self.assertTrue(file.exists())
        self.assertIsNone(process.poll(), "it ended too early to be stopped")


class Stopping(StoppingTest):
    def test_samples(self):
        self.succeed("render", "cornell", "-o", "out.exr", *SMALL, "--spp", "7", "--stats", "s.json")
        self.assertEqual(self.stats()["samples"], 24 * 18 * 7)
        self.assertEqual(self.stats()["stopped_by"], "samples")

    def test_samples_that_adaptive_allocation_gives_are_counted(self):
        done = self.succeed("render", "cornell", "-o", "out.exr", *SMALL, "--spp", "64", "--allocation", "adaptive", "--stats", "s.json")
        mean = self.stats()["samples"] / (24 * 18)
        self.assertGreaterEqual(mean, 64)
        self.assertLess(mean, 65)
        self.assertNotEqual(mean, 64, "every pixel got a sample in every frame")
        self.assertAlmostEqual(self.stats()["samples_per_pixel"], mean, delta=0.01)
        self.assertEqual(float(exr_strings(self.folder / "out.exr")["relume.samples_per_pixel"]), self.stats()["samples_per_pixel"])
        self.assertIn(f"with {self.stats()['samples_per_pixel']:g} samples per pixel", done.stderr)

    def test_time(self):
        self.succeed("render", "cornell", "-o", "out.exr", *SMALL, "--time", "1s", "--stats", "s.json")
        self.assertEqual(self.stats()["stopped_by"], "time")
        # It stops early rather than late; a busy machine may extend the last sample.
        self.assertGreater(self.stats()["render_s"], 0.33)
        self.assertLess(self.stats()["render_s"], 2.5)

    def test_time_that_is_too_short_gives_one_sample(self):
        self.succeed("render", *ROOM, "-o", "out.exr", "--time", "0.0001s", "--stats", "s.json")
        self.assertEqual(self.stats()["samples_per_pixel"], 1)

    def test_error(self):
        self.succeed("render", "cornell", "-o", "out.exr", *SMALL, "--error", "0.1", "--spp", "100000", "--stats", "s.json")
        self.assertEqual(self.stats()["stopped_by"], "error")
        self.assertLessEqual(self.stats()["estimated_error"], 0.1)
        self.assertGreater(self.stats()["samples_per_pixel"], 2)

    def test_interrupt_writes_all_outputs(self):
        checkpoint = self.folder / "a.ckpt"
        process = start("render", *ROOM, *LAYERS, "-o", "out.exr", "--spp", "1000000", "--resume", "a.ckpt", "--checkpoint-interval", "0.2", "--stats", "s.json", cwd=self.folder)
        self.addCleanup(process.kill)
        self.wait_for(checkpoint, process)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        self.assertEqual(self.files(), ["a.ckpt", "out.exr", "s.json"])
        samples = int(exr_strings(self.folder / "out.exr")["relume.samples_per_pixel"])
        self.assertGreater(samples, 0)
        self.assertEqual(self.stats()["samples_per_pixel"], samples)
        # Resuming continues all state, including layers and counters.
        self.succeed("render", *ROOM, *LAYERS, "-o", "resumed.exr", "--spp", samples + 3, "--resume", "a.ckpt", "--stats", "resumed.json")
        self.succeed("render", *ROOM, *LAYERS, "-o", "whole.exr", "--spp", samples + 3, "--stats", "whole.json")
        self.assert_same_pixels("resumed.exr", "whole.exr")
        resumed, whole = (json.loads((self.folder / f"{name}.json").read_text()) for name in ("resumed", "whole"))
        self.assertEqual((resumed["samples"], resumed["rays"]), (whole["samples"], whole["rays"]))

    def test_ignored_interrupts_stay_ignored(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            process = start("render", *ROOM, "--threads", "1", "-o", "out.exr", "--time", "1s", "--resume", f"{number}.ckpt", "--checkpoint-interval", "0.1", cwd=self.folder, ignored=[number])
            self.addCleanup(process.kill)
            self.wait_for(self.folder / f"{number}.ckpt", process)
            process.send_signal(number)
            _, errors = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 0, errors)
            self.assertNotIn("interrupted", errors)

    def test_interrupt_ends_a_sequence_of_single_samples(self):
        process = start("render", *ROOM, "-o", "out.####.png", "--frames", "0-99999", "--spp", "1", "--resume", "a.ckpt", cwd=self.folder)
        self.addCleanup(process.kill)
        self.wait_for(self.folder / "out.0002.png", process)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        last = self.files()[-1]
        self.assertNotIn("interrupted; wrote", errors, "every image has its sample")
        # It continues after the last complete image.
        number = int(re.search(r"\d+", last)[0])
        process = start("render", *ROOM, "-o", "out.####.png", "--frames", f"0-{number + 2}", "--spp", "1", "--resume", "a.ckpt", cwd=self.folder)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, errors)
        self.assertIn(f"of frame {number}", errors)
        self.assertEqual(self.files()[-1], f"out.{number + 2:04}.png")

    def wait_until_it_renders(self, process):
        """Waits until a verbose process reports the built scene."""
        for line in process.stderr:
            if line.startswith("built it in"):
                return
        self.fail("it ended before it rendered")

    def test_preparation_ends_with_the_time(self):
        done = self.succeed("render", "warehouse", "-o", "out.exr", *SMALL, *LISTS, "--time", "1s", "--stats", "s.json", "--resume", "a.ckpt")
        self.assertIn("warning: rendering stopped before the light lists were complete: the image is noisier and no checkpoint was written; raise --time", done.stderr)
        self.assertEqual((self.stats()["stopped_by"], self.stats()["samples_per_pixel"]), ("time", 1))
        self.assertLess(self.stats()["render_s"], 1 + SECONDS_TO_ANSWER)
        # A checkpoint would change bits relative to an uninterrupted render.
        self.assertEqual(self.files(), ["out.exr", "s.json"])
        self.assertGreater(self.metrics("out.exr", "out.exr")["mean_a"][1], 0)

    def test_second_interrupt_ends_at_once(self):
        # The first sample is always completed, and takes seconds here: paths continue until they hit the lamp.
        process = start("render", "cornell-closed", "--width", "640", "--height", "480", "--threads", "1", "--max-bounces", "1024", "--no-path.russian-roulette",
                        "-o", "out.exr", "--stats", "s.json", "--resume", "a.ckpt", "--verbose", cwd=self.folder)
        self.addCleanup(process.kill)
        self.wait_until_it_renders(process)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.stderr.readline(), "stopping once this sample is complete; interrupt again to abort\n")
        self.assertIsNone(process.poll(), "the first interrupt ended it")
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=10)
        self.assertEqual((process.returncode, errors), (130, ""))
        self.assertEqual(self.files(), [])

    def test_termination_is_an_interrupt(self):
        process = start("render", *ROOM, "-o", "out.png", "--spp", "1000000", "--resume", "a.ckpt", "--checkpoint-interval", "0", cwd=self.folder)
        self.addCleanup(process.kill)
        self.wait_for(self.folder / "a.ckpt", process)
        process.send_signal(signal.SIGTERM)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        self.assertIn("interrupted; wrote out.png", errors)
        self.assertEqual(png_size(self.folder / "out.png"), (96, 96))

    def test_kill_and_resume(self):
        # Number of samples that takes about half a second on this machine, five intervals between checkpoints.
        self.succeed("render", *ROOM, "-o", "warm.exr", "--spp", "8", "--stats", "s.json")
        spp = max(64, int(8 * 0.5 / self.stats()["render_s"]))
        arguments = ["render", *ROOM, "--spp", spp, "--seed", "4"]
        checkpoint = self.folder / "a.ckpt"
        process = start(*arguments, "-o", "killed.exr", "--resume", "a.ckpt", "--checkpoint-interval", "0.1", cwd=self.folder)
        self.addCleanup(process.kill)
        self.wait_for(checkpoint, process)
        process.kill()
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, -signal.SIGKILL)
        self.assertFalse((self.folder / "killed.exr").exists())
        done = self.succeed(*arguments, "-o", "resumed.exr", "--resume", "a.ckpt", "--threads", "1", timeout=240)
        self.assertIn("continues from a.ckpt", done.stderr)
        self.succeed(*arguments, "-o", "whole.exr", timeout=240)
        self.assert_same_pixels("resumed.exr", "whole.exr")

    def wait_for_video(self, seconds=60):
        """Waits until the encoder writes; the folder check creates an empty file before."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            with contextlib.suppress(FileNotFoundError):
                if any(file.stat().st_size > 0 for file in self.folder.glob(".out.*")):
                    return
            time.sleep(0.01)
        self.fail("the encoder writes nothing")

    def test_next_render_removes_temporary_files_of_a_killed_one(self):
        env = self.with_encoder('for last; do :; done; cat > "$last"; sleep 1')
        arguments = ["render", "cornell", *SMALL, "--spp", "1", "--frames", "0-1", "-o", "out.y4m"]
        process = start(*arguments, cwd=self.folder, env=env)
        self.addCleanup(process.kill)
        self.wait_for_video()
        process.kill()
        process.communicate(timeout=60)
        (left,) = [name for name in self.files() if name != "bin"]
        self.assertRegex(left, r"^\.out\..*\.tmp\.y4m$")
        self.succeed(*arguments, env=env)
        self.assertEqual(self.files(), ["bin", "out.y4m"])

    def test_an_interrupt_leaves_no_temporary_file(self):
        env = self.with_encoder('for last; do :; done; cat > "$last"; sleep 1')
        process = start("render", "cornell", *SMALL, "--spp", "1", "--frames", "0-1", "-o", "out.y4m", cwd=self.folder, env=env)
        self.addCleanup(process.kill)
        self.wait_for_video()
        for _ in range(2):  # the first one waits for the encoder
            process.send_signal(signal.SIGINT)
            time.sleep(0.1)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertEqual(self.files(), ["bin"])

    def test_finished_checkpoint_is_extended(self):
        self.succeed("render", "cornell", "-o", "a.exr", *SMALL, "--spp", "3", "--resume", "a.ckpt")
        self.succeed("render", "cornell", "-o", "b.exr", *SMALL, "--spp", "5", "--resume", "a.ckpt")
        self.succeed("render", "cornell", "-o", "c.exr", *SMALL, "--spp", "5")
        self.assert_same_pixels("b.exr", "c.exr")

    def test_kill_and_resume_a_sequence(self):
        # The history continues between images, so that every later image depends on the checkpoint.
        arguments = ["render", "turntable", "--width", "96", "--height", "54", "--frames", "0-3", "--spp", "24", "--history", "reproject"]
        process = start(*arguments, "-o", "a.####.exr", "--resume", "a.ckpt", "--checkpoint-interval", "0", cwd=self.folder)
        self.addCleanup(process.kill)
        self.wait_for(self.folder / "a.0001.exr", process)
        process.kill()
        process.communicate(timeout=60)
        done = self.succeed(*arguments, "-o", "a.####.exr", "--resume", "a.ckpt", "--threads", "1", timeout=240)
        self.assertRegex(done.stderr, r"continues from a.ckpt at \d+ samples per pixel of frame [1-3]")
        self.succeed(*arguments, "-o", "whole.####.exr", timeout=240)
        for frame in range(4):
            self.assert_same_pixels(f"a.{frame:04}.exr", f"whole.{frame:04}.exr")

    def test_a_checkpoint_of_another_range_leaves_nothing_out(self):
        arguments = ["render", "turntable", *SMALL, "--spp", "1", "-o", "a.####.png", "--resume", "a.ckpt"]
        self.succeed(*arguments, "--frames", "2-3")
        done = run(*arguments, "--frames", "0-3", cwd=self.folder)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"a\.ckpt: the checkpoint is of frame 3, but frame 0 \(a\.0000\.png\) is missing; delete the checkpoint")
        self.succeed(*arguments, "--frames", "2-4")
        self.assertTrue((self.folder / "a.0004.png").exists())

    def test_images_of_a_scene_at_rest_are_rendered(self):
        for history in ("none", "accumulate", "reproject"):
            arguments = ["render", "cornell", *SMALL, "--frames", "0-3", "--spp", "2", "--history", history]
            self.succeed(*arguments, "-o", f"{history}.####.exr", "--stats", "s.json")
            self.assertEqual(self.stats()["samples"], 4 * 24 * 18 * 2, history)
            for frame in range(3):
                self.assertGreater(self.metrics(f"{history}.{frame:04}.exr", f"{history}.{frame + 1:04}.exr")["mse"], 0, (history, frame))

    def test_kill_and_resume_a_sequence_at_rest(self):
        # No change marks the start of an image, so that the checkpoint must store it.
        arguments = ["render", *ROOM, "--frames", "0-2", "--spp", "24", "--history", "reproject", "--allocation", "adaptive"]
        process = start(*arguments, "-o", "a.####.exr", "--resume", "a.ckpt", "--checkpoint-interval", "0", cwd=self.folder)
        self.addCleanup(process.kill)
        self.wait_for(self.folder / "a.0001.exr", process)
        time.sleep(0.1)  # into the next one
        process.kill()
        process.communicate(timeout=60)
        self.succeed(*arguments, "-o", "a.####.exr", "--resume", "a.ckpt", "--threads", "1", timeout=240)
        self.succeed(*arguments, "-o", "whole.####.exr", timeout=240)
        for frame in range(3):
            self.assert_same_pixels(f"a.{frame:04}.exr", f"whole.{frame:04}.exr")


class InterruptTest(StoppingTest):
    def wait_for_handler(self, process, seconds=60):
        """Waits until the process handles SIGINT, which would end it earlier."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            status = pathlib.Path(f"/proc/{process.pid}/status").read_text()
            if int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16) & 1 << (signal.SIGINT - 1):
                return
            time.sleep(0.005)
        self.fail("it handles no interrupt")

    def answer(self, delay_s, arguments):
        """Interrupts a command after `delay_s`. Returns the time to its end, and whether it reported its remaining
        work. The time is processor time where that is less: other processes slow a command down."""
        cpu_of_others = cpu_seconds_of_ended_children()
        process = start(*arguments, cwd=self.folder)
        self.addCleanup(process.kill)
        self.wait_for_handler(process)
        time.sleep(delay_s)
        begin = time.monotonic()
        cpu_at_begin = cpu_seconds(process.pid)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=120)
        elapsed = time.monotonic() - begin
        self.assertEqual(process.returncode, 130, errors)
        self.assertLess(elapsed, SECONDS_TO_ANSWER, errors)
        seconds = min(elapsed, cpu_seconds_of_ended_children() - cpu_of_others - cpu_at_begin)
        self.assertEqual([name for name in self.files() if name.startswith(".")], [])
        return seconds, "stopping once" in errors

    def assert_answers(self, delay_s, *arguments, has_long_steps=False):
        """Expects an interrupt after `delay_s` to end the command soon, without partial files. Longer work must be
        reported. Only commands with `has_long_steps` (Embree's build of a large scene, experiments) may take longer
        than SECONDS_OF_STEPS."""
        answers = []
        for _ in range(ATTEMPTS):
            answers.append(self.answer(delay_s, arguments))
            seconds, told = answers[-1]
            if seconds < SECONDS_IN_SILENCE or told and (has_long_steps or seconds < SECONDS_OF_STEPS):
                return
        self.fail(f"slow, or does not say what it finishes: {answers}")


class RenderTest(InterruptTest):
    def check(self, delays, *scene):
        """Interrupts a render after each delay, while its scene is loaded, built, prepared or rendered."""
        for delay_s in delays:
            with self.subTest(scene=scene, delay_s=delay_s):
                self.assert_answers(delay_s, "render", *scene, "--width", "160", "--height", "90", "--spp", "1000000", "-o", "out.exr",
                                    has_long_steps=scene[0] in ("city", "cover"))


class InterruptedRenders(RenderTest):
    def test_interrupts_are_answered(self):
        self.check((0.2, 1), "city")  # loading and building take a second or two
        self.check((0.2,), "mine", "--guide", "cdq")
        self.check((0.8,), "warehouse", *LISTS)


class InterruptedAtOtherTimes(RenderTest):
    def test_interrupts_are_answered_after_any_delay(self):
        self.check((0, 2), "city")
        self.check((0, 0.2, 1, 2), "cover")
        self.check((0, 0.8), "mine", "--guide", "cdq")
        self.check((0, 0.2), "warehouse", *LISTS)


class InterruptedCommands(InterruptTest):
    def test_interrupts_of_other_commands_are_answered(self):
        self.succeed("render", "warehouse", "-o", "r.exr", *SMALL, "--spp", "1")
        compare = ["compare", "warehouse", *SMALL, *LISTS, "--techniques", "default", "--reference", "r.exr", "-o", "page"]
        for command in (compare, ["compare", "warehouse", *SMALL, *LISTS, "--techniques", "default", "--timing", "4"], ["compare", "city", *SMALL, "--cache-dir", "cache", "-o", "page"],
                        ["export", "cover", "-o", "cover.gltf"], ["info", "cover"], ["experiment", "run", "guide-cost", "--cache-dir", "cache", "-o", "pages"]):
            for delay_s in (0, 1.5 if "city" in command else 0.8):
                with self.subTest(command=command[:2], delay_s=delay_s):
                    if delay_s > 0 and command[0] in ("export", "info"):
                        continue  # already finished
                    self.assert_answers(delay_s, *command, has_long_steps="city" in command or command[0] == "experiment")


if __name__ == "__main__":
    unittest.main(defaultTest=sys.argv[1:] or None, argv=sys.argv[:1])
