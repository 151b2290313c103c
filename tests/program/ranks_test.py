#!/usr/bin/env python3
"""Tests renders on several ranks, with Open MPI and with MPICH."""

import json
import os
import re
import signal
import subprocess
import time

import program
from program import exr_channels, exr_pixels, exr_strings
from ranks import FOLDER, RanksTest, cpu_seconds, end_processes, main, rank_process

LAYERS = "albedo,normal,depth,motion,variance,heatmap,samples"
SMALL = ["--width", "48", "--height", "36", "--threads", "1"]


class Images(RanksTest):
    look = ["render", "cornell", *SMALL, "--aov", LAYERS, "--spp", "72"]  # five deals of 16: one per rank, the last half full
    ranks = (1, 2, 5)  # all blocks, uneven numbers of them, one of each

    def whole(self, *arguments):
        self.succeed(*self.look, "-o", "whole.exr", *arguments)
        return exr_pixels(self.folder / "whole.exr")

    def test_any_number_of_ranks_gives_the_same_bits(self):
        whole = self.whole()
        for ranks in self.ranks:
            done = self.succeed_on_ranks(ranks, *self.look, "-o", "out.exr")
            self.assertEqual(done.stderr.count("wrote out.exr with 72 samples per pixel"), 1, done.stderr)
            self.assertEqual(exr_channels(self.folder / "out.exr"), exr_channels(self.folder / "whole.exr"))
            self.assertTrue(exr_pixels(self.folder / "out.exr") == whole, f"{ranks} ranks give other bits")
        self.assertEqual(self.files(), ["out.exr", "whole.exr"])

    def test_a_window_has_the_same_bits(self):
        whole = self.whole("--crop", "7,5,20,11")
        self.succeed_on_ranks(3, *self.look, "-o", "out.exr", "--crop", "7,5,20,11")
        self.assertTrue(exr_pixels(self.folder / "out.exr") == whole)

    def test_a_display_image_has_the_same_exposure(self):
        look = ["render", "cornell", *SMALL, "--spp", "64", "--exposure", "auto"]
        self.succeed(*look, "-o", "whole.png")
        self.succeed_on_ranks(3, *look, "-o", "out.png")
        self.assert_same_pixels("whole.png", "out.png")

    def test_more_samples_continue_with_and_without_mpirun(self):
        look = ["render", "cornell", *SMALL, "-o", "out.exr", "--resume", "out.ckpt"]
        self.succeed_on_ranks(3, *look, "--spp", "40")
        self.succeed_on_ranks(2, *look, "--spp", "70")
        done = self.succeed(*look, "--spp", "100")
        self.assertIn("continues from out.ckpt at 68 samples per pixel", done.stderr)
        self.succeed("render", "cornell", *SMALL, "-o", "whole.exr", "--spp", "100")
        self.assertTrue(exr_pixels(self.folder / "out.exr") == exr_pixels(self.folder / "whole.exr"))
        self.refused(1, "out.ckpt", "render", "furnace", *SMALL, "-o", "out.exr", "--resume", "out.ckpt")
        self.succeed("render", "cornell", *SMALL, "-o", "out.exr", "--spp", "16", "--resume", "one.ckpt")
        self.refused(1, "is the checkpoint of a render without mpirun", "render", "cornell", *SMALL, "-o", "out.exr", "--resume", "one.ckpt")

    def test_time_and_error_hold_for_the_whole(self):
        look = ["render", "cornell", *SMALL, "-o", "out.exr", "--stats", "s.json"]
        self.succeed_on_ranks(2, *look, "--spp", "0", "--time", "0.5s")
        stats = json.loads((self.folder / "s.json").read_text())
        self.assertEqual(stats["stopped_by"], "time")
        self.assertGreater(stats["samples_per_pixel"], 0)
        self.succeed_on_ranks(2, *look, "--spp", "0", "--error", "0.1")
        stats = json.loads((self.folder / "s.json").read_text())
        self.assertEqual(stats["stopped_by"], "error")
        self.assertLessEqual(stats["estimated_error"], 0.1)

    def test_techniques_that_learn_are_independent_renders(self):
        self.succeed_on_ranks(2, "render", "cornell", *SMALL, "--lights", "vlc", "--spp", "64", "-o", "out.exr", "--resume", "out.ckpt")
        self.assertEqual(exr_strings(self.folder / "out.exr")["relume.samples_per_pixel"], "64")
        self.assertGreaterEqual(int(exr_strings(self.folder / "out.ckpt")["relume.replicas"]), 1)

    def refused(self, code, sentence, *arguments, **variables):
        done = self.on_ranks(2, *arguments, **variables)
        self.assertIn(sentence, done.stderr)
        self.assertEqual(done.stderr.count(sentence), 1, done.stderr)
        self.assertEqual(done.returncode, code, done.stderr)

    def test_what_cannot_be_shared_is_refused_once(self):
        self.refused(2, "a denoised image is no mean", "render", "cornell", *SMALL, "-o", "no.exr", "--denoise", "svgf")
        self.refused(2, "remove it", "render", "cornell", *SMALL, "-o", "no.exr", "--sample-range", "0-15")
        self.refused(2, "--stats describes one process", "render", "turntable", *SMALL, "-o", "no.####.exr", "--frames", "0-1", "--stats", "no.json")
        self.refused(2, "scenes runs as one process", "scenes")
        self.refused(1, "nowhere.glb", "render", "nowhere.glb", *SMALL, "-o", "no.exr")
        self.assertEqual(self.files(), [])

    def test_only_the_plugin_needs_mpi(self):
        def libraries(file):
            return subprocess.run(["ldd", str(file)], check=True, capture_output=True, text=True, timeout=60).stdout

        self.assertNotIn("libmpi", libraries(program.PROGRAM))
        self.assertIn("libmpi", libraries(FOLDER / f"relume-mpi-{self.library}.so"))

    def test_a_missing_plugin_is_named(self):
        done = self.on_ranks(2, "render", "cornell", *SMALL, "-o", "no.exr", RELUME_MPI_PLUGIN="/nowhere.so")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(f"relume-mpi-{self.library}.so cannot be loaded", done.stderr)


class Sequences(RanksTest):
    look = ["render", "turntable", *SMALL, "--frames", "0-10", "--fps", "8", "--spp", "4"]

    def test_frames_have_the_bits_of_one_process(self):
        # turntable moves in each, so no frame continues the samples of another.
        look = [*self.look, "--aov", "motion,variance"]
        self.succeed(*look, "-o", "a.####.exr")
        done = self.succeed_on_ranks(3, *look, "-o", "b.####.exr")
        self.assertEqual(done.stderr.count("wrote b."), 11, done.stderr)
        for frame in range(11):
            same = exr_pixels(self.folder / f"a.{frame:04}.exr") == exr_pixels(self.folder / f"b.{frame:04}.exr")
            self.assertTrue(same, f"frame {frame} has other bits")

    def test_exposures_adapt_over_all_ranks(self):
        self.succeed(*self.look, "-o", "a.####.png", "--exposure", "auto")
        self.succeed_on_ranks(3, *self.look, "-o", "b.####.png", "--exposure", "auto")
        for frame in range(11):
            self.assert_same_pixels(f"a.{frame:04}.png", f"b.{frame:04}.png")


class Lost(RanksTest):
    look = ["render", "cornell", "--width", "96", "--height", "72", "--threads", "1", "--spp", "4000"]
    resumed = ["--resume", "out.ckpt", "--checkpoint-interval", "0.2s"]
    whole = None  # pixels of a render by one process

    def start_until_checkpoint(self, *options):
        process, mark = self.start_on_ranks(3, *self.look, "-o", "out.exr", *options)
        self.wait_for((self.folder / "out.ckpt").exists, "a checkpoint")
        return process, mark

    def assert_resumes(self, ranks):
        done = self.succeed("merge", "out.ckpt", "-o", "so_far.exr")
        self.assertIn("samples per pixel", done.stderr)
        done = self.succeed_on_ranks(ranks, *self.look, "-o", "out.exr", *self.resumed, timeout=400)
        self.assertIn("continues from out.ckpt at", done.stderr)
        if type(self).whole is None:
            self.succeed(*self.look, "-o", "whole.exr", timeout=400)
            type(self).whole = exr_pixels(self.folder / "whole.exr")
        self.assertTrue(exr_pixels(self.folder / "out.exr") == self.whole)

    def test_a_lost_rank_leaves_a_checkpoint_for_any_number_of_ranks(self):
        process, mark = self.start_until_checkpoint(*self.resumed)
        victim = rank_process(mark, 1)
        self.assertIsNotNone(victim)
        os.kill(victim, signal.SIGKILL)
        self.assertNotEqual(process.wait(60), 0)
        self.assert_resumes(2)

    def test_a_lost_rank_0_leaves_a_checkpoint(self):
        process, mark = self.start_until_checkpoint(*self.resumed)
        victim = rank_process(mark, 0)
        self.assertIsNotNone(victim)
        os.kill(victim, signal.SIGKILL)
        self.assertNotEqual(process.wait(60), 0)
        self.assert_resumes(1)

    def test_a_job_that_is_killed_at_once_loses_an_interval_at_most(self):
        process, mark = self.start_until_checkpoint("--resume", "out.ckpt", "--checkpoint-interval", "1s")
        time.sleep(2.5)
        self.assertIsNone(process.poll(), self.errors())
        age = time.time() - (self.folder / "out.ckpt").stat().st_mtime
        end_processes(mark)  # mpirun, too
        process.wait(30)
        print(f"the checkpoint was {age:.1f} s old")
        self.assertLess(age, 4, "an interval of a second, and a deal of half a second on a busy machine")
        self.assert_resumes(4)

    def test_a_sequence_continues_on_another_number_of_ranks(self):
        look = ["render", "turntable", "--width", "96", "--height", "72", "--threads", "1", "--frames", "0-40", "--fps", "8", "--spp", "32", "--resume", "out.ckpt"]
        process, mark = self.start_on_ranks(3, *look, "-o", "b.####.exr")
        self.wait_for(lambda: (self.folder / "out.ckpt").exists() and rank_process(mark, 2), "a checkpoint")
        os.kill(rank_process(mark, 2), signal.SIGKILL)
        process.wait(60)
        done = self.succeed_on_ranks(2, *look, "-o", "b.####.exr")
        self.assertIn("continues from out.ckpt after", done.stderr)
        self.assertEqual(len([name for name in self.files() if name.startswith("b.")]), 41)


class Silent(RanksTest):
    """Ranks that are stopped keep their connections: only the heartbeat shows that they are lost."""

    look = ["render", "cornell", "--width", "96", "--height", "72", "--threads", "1"]
    resumed = ["--resume", "out.ckpt", "--checkpoint-interval", "1s"]

    def stop(self, rank, sentence):
        """Stops a rank, and waits for the sentence and the end of the job. Returns the seconds until the sentence."""
        process, mark = self.start_on_ranks(3, *self.look, "--spp", "1000000", "-o", "out.exr", *self.resumed)
        self.wait_for((self.folder / "out.ckpt").exists, "a checkpoint")
        victim = rank_process(mark, rank)
        self.assertIsNotNone(victim)
        os.kill(victim, signal.SIGSTOP)
        start = time.monotonic()
        self.wait_for(lambda: sentence in self.errors(), sentence)
        seconds = time.monotonic() - start
        self.assertNotEqual(process.wait(60), 0)
        print(f"rank {rank}: noticed after {seconds:.0f} s, ended after {time.monotonic() - start:.0f} s")
        self.assertLess(time.monotonic() - start, 60)
        return seconds

    def assert_resumes(self):
        done = self.succeed("merge", "out.ckpt", "-o", "so_far.exr")
        samples = str(int(re.search(r"with (\d+) samples per pixel", done.stderr)[1]) + 200)
        done = self.succeed_on_ranks(2, *self.look, "--spp", samples, "-o", "out.exr", *self.resumed, timeout=600)
        self.assertIn("continues from out.ckpt at", done.stderr)
        self.succeed(*self.look, "--spp", samples, "-o", "whole.exr", timeout=1200)
        self.assertTrue(exr_pixels(self.folder / "out.exr") == exr_pixels(self.folder / "whole.exr"))

    def test_a_silent_rank_is_noticed_within_30_s(self):
        self.assertLess(self.stop(1, "cannot be reached any more; continue from out.ckpt"), 30)
        lines = re.findall(r"^(.*?)(\d+)/1000000 samples", self.errors(), re.MULTILINE)
        self.assertTrue(lines, self.errors())
        self.assertEqual({label for label, _ in lines}, {"3 ranks, "}, "one line of progress, of all ranks")
        samples = [int(number) for _, number in lines]
        self.assertEqual(samples, sorted(set(samples)))
        self.assert_resumes()

    def test_a_silent_rank_0_ends_the_others(self):
        seconds = self.stop(0, "lost the connection to rank 0 and ends; continue from out.ckpt")
        self.assertLess(seconds, 32, "30 s, and the delay until the message is printed")
        self.assert_resumes()


class Uneven(RanksTest):
    def test_a_slow_rank_does_not_hold_the_others(self):
        look = ["render", "cornell", "--width", "96", "--height", "72", "--threads", "1", "--spp", "3000"]
        start = time.monotonic()
        self.succeed_on_ranks(2, *look, "-o", "two.exr", timeout=600)
        two_s = time.monotonic() - start
        start = time.monotonic()
        process, mark = self.start_on_ranks(3, *look, "-o", "out.exr")
        self.wait_for(lambda: (number := rank_process(mark, 2)) and cpu_seconds(number) > 1.5, "a long deal of rank 2")
        slow = rank_process(mark, 2)
        while "wrote out.exr" not in self.errors():  # a twentieth of its speed
            self.assertIsNone(process.poll(), self.errors())
            self.assertLess(time.monotonic() - start, 2 * two_s + 5, "the slow rank holds the others")
            os.kill(slow, signal.SIGCONT)
            time.sleep(0.01)
            os.kill(slow, signal.SIGSTOP)
            time.sleep(0.19)
        print(f"two ranks: {two_s:.1f} s; with a third one that becomes slow: {time.monotonic() - start:.1f} s")
        os.kill(slow, signal.SIGCONT)
        self.assertEqual(process.wait(60), 0, self.errors())
        self.assertTrue(exr_pixels(self.folder / "out.exr") == exr_pixels(self.folder / "two.exr"))


class Seams(RanksTest):
    def test_frames_are_as_good_as_those_of_one_run(self):
        look = ["render", "turntable", *SMALL, "--frames", "0-11", "--fps", "24", "--spp", "1", "--history", "reproject"]
        self.succeed("render", "turntable", *SMALL, "--frames", "0-11", "--fps", "24", "--spp", "512", "-o", "ref.####.exr")
        self.succeed(*look, "-o", "one.####.exr")
        self.succeed_on_ranks(2, *look, "-o", "warm.####.exr")
        self.succeed_on_ranks(2, *look, "-o", "cold.####.exr", "--warmup", "0")

        def error(name):  # of all frames after the first: at least one begins a segment
            return sum(self.metrics(f"{name}.{i:04}.exr", f"ref.{i:04}.exr")["flip"] for i in range(1, 12))

        one, warm, cold = error("one"), error("warm"), error("cold")
        print(f"FLIP over that of one run: {warm / one:.2f} with warm-up, {cold / one:.2f} without")
        self.assertLess(warm, 1.2 * one)
        self.assertGreater(cold, warm)

    def test_the_seam_of_a_segment_is_measured(self):
        """FLIP of a segment's first frame over that of the same frame of one run: its MSE depends on single pixels."""
        frames = ["render", "turntable", *SMALL, "--frames", "0-31", "--fps", "24"]
        look = [*frames, "--spp", "1", "--history", "reproject"]
        self.succeed(*frames, "--spp", "512", "-o", "ref.####.exr", timeout=600)
        self.succeed(*look, "-o", "one.####.exr")
        self.succeed_on_ranks(2, *look, "-o", "warm.####.exr")
        self.succeed_on_ranks(2, *look, "-o", "cold.####.exr", "--warmup", "0")

        def ratio(name, warmup):
            texts = [exr_strings(self.folder / f"{name}.{i:04}.exr") for i in range(32)]
            # Frames 0 to 8 have complete histories after warm-up, so they are left out.
            seams = [i for i in range(9, 32) if "relume.warmup" in texts[i]]
            self.assertTrue(seams, "segments of 32 frames on two ranks")
            self.assertEqual({texts[i]["relume.warmup"] for i in seams}, {warmup})
            errors = {run: [self.metrics(f"{run}.{i:04}.exr", f"ref.{i:04}.exr")["flip"] for i in seams] for run in (name, "one")}
            each = ", ".join(f"{i}: {own / other:.2f}" for i, own, other in zip(seams, errors[name], errors["one"]))
            print(f"FLIP of seams over that of the same frames of one run, {warmup} frames of warm-up: {each}")
            return sum(errors[name]) / sum(errors["one"])

        warm, cold = ratio("warm", "8"), ratio("cold", "0")
        print(f"all seams: {warm:.2f} with warm-up, {cold:.2f} without")
        # A history has at most 16 samples while objects move. At a seam it has nine with warm-up, and one without.
        self.assertLess(warm, 1.2)
        self.assertLess(warm - 1, 0.5 * (cold - 1))
        self.assertNotIn("relume.warmup", exr_strings(self.folder / "one.0020.exr"))


class Comparisons(RanksTest):
    look = ["compare", "cornell", *SMALL, "--techniques", "default,few=max-bounces:1", "--repeat", "3", "--reference-spp", "16"]

    def result(self, folder):
        return json.loads((self.folder / folder / "compare.json").read_text())

    def figures(self, folder):
        """All of a comparison except times, the machine, and notes, which may concern times."""
        result = self.result(folder)
        del result["machine"], result["notes"]
        for contender in result["contenders"]:
            for name in ("passes", "time_s", "ms_per_frame"):
                del contender[name]
            for repetition in contender["repetitions"]:
                for point in repetition["points"]:
                    del point["time_s"]
        return result

    def test_figures_are_those_of_one_process(self):
        self.succeed(*self.look, "--spp", "4", "--cache-dir", "a", "-o", "one")
        done = self.succeed_on_ranks(2, *self.look, "--spp", "4", "--cache-dir", "b", "-o", "two")
        self.assertEqual(done.stderr.count("wrote two/compare.html"), 1, done.stderr)
        self.assertEqual(self.figures("two"), self.figures("one"))
        self.assertEqual(self.result("two")["machine"]["ranks"], 2)
        self.assertEqual(sum("parallel load" in note for note in self.result("two")["notes"]), 1)
        self.assertIn("under parallel load", done.stderr)
        self.assertEqual(done.stdout, (self.folder / "two/compare.csv").read_text())
        self.assertEqual([file.suffix for file in (self.folder / "b").rglob("*") if file.is_file()], [".exr"])

    def test_equal_time_is_measured_on_one_rank_of_a_machine(self):
        done = self.succeed_on_ranks(3, *self.look, "--budget", "50ms", "--cache-dir", "a", "-o", "out")
        result = self.result("out")
        self.assertEqual((result["mode"], result["repetitions"]), ("equal-time", 3))
        self.assertEqual([len(contender["repetitions"]) for contender in result["contenders"]], [3, 3])
        self.assertNotIn("parallel load", done.stderr)

    def test_errors_are_printed_once(self):
        for code, sentence, arguments in ((2, "--timing measures one process", [*self.look, "--timing", "4"]), (2, "choose one", [*self.look, "--spp", "4", "--budget", "1s"]),
                                          (1, "nowhere.glb", ["compare", "nowhere.glb", *SMALL])):
            done = self.on_ranks(2, *arguments)
            self.assertEqual(len(re.findall(r"^relume: ", done.stderr, re.MULTILINE)), 1, done.stderr)
            self.assertIn(sentence, done.stderr)
            self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(self.files(), [])


class LostComparisons(RanksTest):
    def test_a_lost_rank_ends_the_job_and_leaves_the_reference(self):
        look = ["compare", "cornell", *SMALL, "--techniques", "default,few=max-bounces:1", "--repeat", "2", "--reference-spp", "64", "--cache-dir", "cache", "-o", "out"]
        process, mark = self.start_on_ranks(2, *look, "--spp", "1000000")
        self.wait_for(lambda: any(self.folder.glob("cache/**/reference-*.exr")), "a reference")
        victim = rank_process(mark, 1)
        self.assertIsNotNone(victim)
        os.kill(victim, signal.SIGKILL)
        self.assertNotEqual(process.wait(60), 0)
        self.assertFalse((self.folder / "out/compare.json").exists())
        self.succeed_on_ranks(2, *look, "--spp", "4", timeout=400)
        self.assertTrue(json.loads((self.folder / "out/compare.json").read_text())["reference"]["cached"])


class MpichImages(Images):
    library = "mpich"
    ranks = (1, 2, 4, 5)


class MpichSequences(Sequences):
    library = "mpich"


class MpichLost(Lost):
    library = "mpich"


class MpichSilent(Silent):
    library = "mpich"


class MpichUneven(Uneven):
    library = "mpich"


class MpichComparisons(Comparisons):
    library = "mpich"


class MpichLostComparisons(LostComparisons):
    library = "mpich"


if __name__ == "__main__":
    main()
