#!/usr/bin/env python3
"""tools/scaling_model and tools/measure_ranks: limits of the model that are known, its fit, its page, and the plan of measurements."""

import dataclasses
import importlib.machinery
import importlib.util
import math
import pathlib
import random
import re
import sys
import tempfile
import unittest
import unittest.mock

import house

sys.dont_write_bytecode = True
sys.path.insert(0, str(house.ROOT / "tools/scaling"))

import dealers  # noqa: E402
import fit  # noqa: E402
import launch  # noqa: E402
import page  # noqa: E402
import sequence  # noqa: E402
import still_image  # noqa: E402
from launch import Costs, Job  # noqa: E402
from simulation import random_losses, simulate  # noqa: E402


def load(name):
    loader = importlib.machinery.SourceFileLoader(name, str(house.ROOT / "tools" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


measure_ranks = load("measure_ranks")
FREE = Costs(samples_per_s=1e6, plane_s=0.0, bandwidth=math.inf, latency_s=-launch.POLL_S)  # no overhead at all
BLOCK = dealers.BLOCK_SAMPLES
STILL = Job("still", 100_000, BLOCK * 1024)
LONG = Job("long", 100_000, BLOCK * 2**16)  # the last, smaller deals are few
DEAL = dealers.LEAST_BLOCKS * BLOCK  # samples of a deal with the shortest interval between checkpoints
DEAL_S = DEAL * LONG.pixels / FREE.samples_per_s  # 1.6 s


class Constants(unittest.TestCase):
    def test_are_those_of_the_program(self):
        sources = "\n".join(p.read_text(encoding="utf-8") for p in sorted((house.ROOT / "apps/relume/ranks").glob("*.[hc]*")))
        for name, value in (("kLostAfter_s", launch.LOST_AFTER_S), ("kCoordinatorLostAfter_s", launch.COORDINATOR_LOST_AFTER_S), ("kLongestDeal_s", still_image.LONGEST_DEAL_S),
                            ("kShortestDeal_s", still_image.SHORTEST_DEAL_S), ("kDealsPerInterval", still_image.DEALS_PER_INTERVAL), ("kLongestSegment", sequence.LONGEST_SEGMENT),
                            ("kLeastBlocks", dealers.LEAST_BLOCKS), ("kLeastLastDeal_s", dealers.LEAST_LAST_DEAL_S), ("kPartsPerRank", dealers.PARTS_PER_RANK), ("kReceivedSums", still_image.RECEIVED_SUMS), ("kWaitingResults", still_image.WAITING_RESULTS)):  # fmt: skip
            self.assertEqual({float(v) for v in re.findall(rf"\b{name} = ([\d.]+);", sources)}, {float(value)}, name)
        self.assertIn(f"offsetof(PixelSums, surface) == {launch.SUM_BYTES},", sources)
        self.assertIn(f"kSmallBytes = uint64_t{{{launch.SMALL_BYTES >> 10}}} << 10;", sources)
        self.assertIn(f"kReceiveBytes = uint64_t{{{launch.RECEIVE_BYTES >> 20}}} << 20;", sources)
        self.assertIn("kIdlePause = std::chrono::milliseconds(3);", sources)
        sums = (house.ROOT / "src/framebuffer/pixel_sums.h").read_text(encoding="utf-8")
        self.assertIn(f"sizeof(PixelSums) == {launch.IMAGE_SUM_BYTES},", sums)
        self.assertIn(f"kBlockSamples = {BLOCK};", sums)
        self.assertEqual(measure_ranks.BLOCK_SAMPLES, BLOCK)


class StillImages(unittest.TestCase):
    def test_scale_perfectly_without_overhead(self):
        one = simulate(LONG, 1, FREE).seconds
        self.assertAlmostEqual(one, LONG.pixels * LONG.samples / FREE.samples_per_s)
        for ranks in (2, 8, 64):
            # The last deals take at least a second, so ranks end up to one block apart.
            self.assertAlmostEqual(simulate(LONG, ranks, FREE).seconds * ranks / one, 1, delta=0.003)

    def test_use_at_most_one_rank_per_first_deal(self):
        job = dataclasses.replace(STILL, samples=DEAL * 4)
        self.assertAlmostEqual(simulate(job, 4, FREE).seconds, simulate(job, 64, FREE).seconds)
        self.assertAlmostEqual(simulate(job, 64, FREE).idle, 1 - 4 / 64)

    def test_saturate_the_network_at_the_computed_number_of_ranks(self):
        costs = dataclasses.replace(FREE, bandwidth=launch.SUM_BYTES * LONG.pixels / (DEAL_S / 16), interval_s=1.0)
        least_s = launch.SUM_BYTES * LONG.pixels / costs.bandwidth * LONG.samples / DEAL
        four, eight, many, more = (simulate(LONG, ranks, costs) for ranks in (4, 8, 64, 128))
        # A rank renders for 16 transfers, and sends meanwhile, so 17 ranks saturate the link. Fewer ranks do not wait.
        self.assertAlmostEqual(four.seconds / eight.seconds, 2, delta=0.02)
        for outcome in (many, more):
            # The link is never idle. It does not carry the samples of rank 0: at most one of 17 deals.
            self.assertLess(1 - 1 / 17, outcome.seconds / least_s)
            self.assertLess(outcome.seconds / least_s, 1.03)
            self.assertEqual(page.limit(LONG, outcome), "network of rank 0")

    def test_saturate_the_thread_that_adds(self):
        costs = dataclasses.replace(FREE, plane_s=DEAL_S / 10 / LONG.pixels, cores=1000, merge_cores=1, interval_s=1.0)
        outcome = simulate(LONG, 64, costs)
        # Rank 0 deals after each result, so that it waits only for the first one, and for samples that it rendered again.
        added = outcome.seconds / (LONG.samples / DEAL * DEAL_S / 10)
        self.assertLess(1, added)
        self.assertLess(added, 1.06)
        self.assertEqual(page.limit(LONG, outcome), "rank 0 adds results")

    def test_render_a_slow_ranks_samples_again(self):
        costs = dataclasses.replace(FREE, spread=1.0)
        self.assertGreater(simulate(STILL, 64, costs).share("again"), 0)

    def test_hold_the_results_that_fit_into_the_limit(self):
        job, costs = Job("large", 4_000_000, BLOCK * 64), dataclasses.replace(FREE, bandwidth=1e9)
        sums = still_image.RECEIVED_SUMS * launch.IMAGE_SUM_BYTES * job.pixels
        self.assertGreater(sums, launch.RECEIVE_BYTES)
        results = sums // (launch.SUM_BYTES * job.pixels)  # the largest number that fits
        self.assertEqual(simulate(job, 64, costs).memory, job.pixels * (launch.IMAGE_SUM_BYTES + results * launch.SUM_BYTES))
        small = dataclasses.replace(STILL, samples=DEAL * 8)  # all fit; that of rank 0 needs no transfer
        costs = dataclasses.replace(FREE, bandwidth=1e8)
        self.assertEqual(simulate(small, 8, costs).memory, small.pixels * (launch.IMAGE_SUM_BYTES + 7 * launch.SUM_BYTES))


class LostRanks(unittest.TestCase):
    COSTS = dataclasses.replace(FREE, load_s=3.0, checkpoint_s=1e-6, write_s=1e-6, interval_s=20.0)
    JOB = Job("still", 100_000, BLOCK * 8192)

    def test_cost_at_most_an_interval_the_heartbeat_and_a_start(self):
        ranks = 8
        whole = simulate(self.JOB, ranks, self.COSTS).seconds
        self.assertGreater(whole, 300)
        end_s = launch.ABANDON_S + self.JOB.pixels * (self.COSTS.checkpoint_s + self.COSTS.write_s)
        for rank, noticed_s in ((0, launch.COORDINATOR_LOST_AFTER_S), (1, launch.LOST_AFTER_S)):
            for time in (4.0, 50.0, 0.4 * whole, 0.8 * whole):
                outcome = simulate(self.JOB, ranks, self.COSTS, losses=[(time, rank)])
                self.assertEqual(outcome.restarts, 1)
                # A checkpoint lacks the deals that were in progress when it began.
                bound = self.COSTS.interval_s + still_image.LONGEST_DEAL_S + noticed_s + self.COSTS.load_s + end_s
                self.assertLess(outcome.seconds - whole, bound, f"rank {rank} after {time} s")
                self.assertGreater(outcome.seconds, whole)

    def test_of_a_sequence_cost_the_frames_in_progress(self):
        job = Job("frames", 100_000, 16, frames=400)
        whole = simulate(job, 4, self.COSTS).seconds
        outcome = simulate(job, 4, self.COSTS, losses=[(whole / 2, 2)])
        self.assertEqual(outcome.restarts, 1)
        self.assertLess(outcome.seconds, 1.5 * whole + launch.LOST_AFTER_S)

    def test_come_at_their_rate(self):
        losses = random_losses(100, 1.0, 86400 * 10, seed=3)
        self.assertLess(abs(len(losses) - 1000), 5 * math.sqrt(1000))


class Sequences(unittest.TestCase):
    JOB = Job("frames", 100_000, 16, frames=512)

    def test_scale_perfectly_without_overhead(self):
        one = simulate(self.JOB, 1, FREE).seconds
        for ranks in (2, 8, 64):
            self.assertAlmostEqual(simulate(self.JOB, ranks, FREE).seconds * ranks / one, 1, delta=1e-9)

    def test_are_limited_by_the_images_that_rank_0_writes(self):
        costs = dataclasses.replace(FREE, write_s=16 / FREE.samples_per_s / 8, cores=1000)
        outcome = simulate(self.JOB, 64, costs)
        writes = outcome.seconds / (self.JOB.pixels * costs.write_s)  # in order: first and last segments have up to four frames, eight writes each
        self.assertLess(self.JOB.frames, writes)
        self.assertLess(writes, self.JOB.frames + 2 * 4 * 8)
        self.assertEqual(page.limit(self.JOB, outcome), "rank 0 writes images")

    def test_warm_up_before_each_segment(self):
        warm = simulate(dataclasses.replace(self.JOB, warmup=8), 64, FREE)
        self.assertGreater(warm.share("again"), 0.5)


class Runs(unittest.TestCase):
    def test_with_one_seed_are_equal(self):
        for job in (page.JOBS[0], page.JOBS[3]):
            self.assertEqual(simulate(job, 16, page.ASSUMED, seed=5), simulate(job, 16, page.ASSUMED, seed=5))
            self.assertNotEqual(simulate(job, 16, page.ASSUMED, seed=5), simulate(job, 16, page.ASSUMED, seed=6))

    def test_account_for_the_time_of_all_ranks(self):
        for job in page.JOBS:
            for losses in ((), [(5.0, 1)], [(5.0, 0)]):
                self.assertAlmostEqual(simulate(job, 8, page.ASSUMED, losses=losses).share(*launch.STATES), 1)


def measurement(noise, outlier=1.0):
    """Runs with known parameters."""
    values = {"start_s": 1.6, "mpi_s": 1.2, "rank_s": 0.08, "slowdown": 0.03, "plane_s": 4e-7, "samples_per_s render": math.log(2.3e5), "samples_per_s planes": math.log(1.5e6)}
    numbers = random.Random(3)
    jobs = []
    for name, (width, height, arguments) in measure_ranks.JOBS.items():
        samples = {"start": 16, "render": 1104, "planes": 640}[name]
        runs = []
        for repetition in range(4):
            for ranks in measure_ranks.RANKS:
                seconds = fit.predicted(Job(name, width * height, samples), ranks, values, 3600) * math.exp(numbers.gauss(0, noise))
                runs.append({"ranks": ranks, "repetition": repetition, "seconds": seconds * (outlier if ranks == 8 else 1)})
        jobs.append({"name": name, "width": width, "height": height, "samples": samples, "arguments": arguments, "runs": runs, "ratios": measure_ranks.ratios(runs)})
    return values, {"machine": {"Processor": "P"}, "setup": {"share": 0.2, "checkpoint_interval_s": 3600, "repetitions": 4}, "jobs": jobs}


class Fits(unittest.TestCase):
    def test_find_known_parameters_and_predict_eight_ranks(self):
        values, stored = measurement(0.01)
        parameters, predictions = fit.Fit(stored).intervals()
        self.assertAlmostEqual(parameters["start_s"][0], values["start_s"], delta=0.1)
        self.assertAlmostEqual(parameters["slowdown"][0], values["slowdown"], delta=0.01)
        self.assertAlmostEqual(parameters["plane_s"][0] / values["plane_s"], 1, delta=0.4)
        self.assertEqual(len(predictions), 3)
        for _, _, _, _, error, _, _ in predictions:
            self.assertLess(abs(error), 0.05)

    def test_report_a_wrong_prediction(self):
        for _, _, _, _, error, low, high in fit.Fit(measurement(0.01, outlier=1.2)[1]).intervals()[1]:
            self.assertAlmostEqual(error, 1 / 1.2 - 1, delta=0.05)
            self.assertLess(high, 0)
            self.assertLess(low, high)


class Page(unittest.TestCase):
    """With fewer simulations: house.scaling makes the whole page."""

    def setUp(self):
        fewer = unittest.mock.patch.multiple(page, PLOTTED=page.PLOTTED[:2], SENSITIVE_RANKS=8)
        fewer.start()
        self.addCleanup(fewer.stop)

    def test_says_that_no_measurement_is_stored(self):
        text, plot = page.page(None)
        self.assertIn("No measurement is stored yet.", text)
        self.assertNotIn("Prediction for 8", text)
        self.assertIn("prefers-color-scheme:dark", plot)

    def test_has_the_measurement_and_its_prediction(self):
        text, _ = page.page(measurement(0.01)[1])
        self.assertNotIn("No measurement is stored yet.", text)
        self.assertIn("### Prediction for 8 ranks", text)
        self.assertIn("| `planes` | ", text.split("### Prediction for 8 ranks")[1])
        self.assertRegex(text, r"\| fitted: [\d,.]+ ns with 0\.2 cores, times 0\.2 \|")
        self.assertLessEqual(max(len(line) for line in text.splitlines() if not line.startswith("|")), 100)


class Measuring(unittest.TestCase):
    def test_limits_groups_by_both_versions_of_control_groups(self):
        self.assertEqual(measure_ranks.quota_files(1, 0.2), {"cpu.cfs_period_us": "20000", "cpu.cfs_quota_us": "4000"})
        self.assertEqual(measure_ranks.quota_files(2, 0.2), {"cpu.max": "4000 20000"})
        with tempfile.TemporaryDirectory() as scratch:
            root = pathlib.Path(scratch)
            with self.assertRaisesRegex(measure_ranks.NoQuota, "no controller of processors; run this on"):
                measure_ranks.hierarchy(root)
            (root / "cpu").mkdir()
            (root / "cpu/cpu.cfs_quota_us").write_text("-1")
            self.assertEqual(measure_ranks.hierarchy(root), (root / "cpu", 1))
            (root / "cgroup.controllers").write_text("memory cpu")
            self.assertEqual(measure_ranks.hierarchy(root), (root, 2))

    def test_takes_the_time_that_is_given(self):
        one = measure_ranks.time_of_one(10, 4, 1.5)
        self.assertLess(60 * 10 * 0.8, 4 * (2 * one * sum(1 / n for n in measure_ranks.RANKS) + 5 * 1.5 * 3))
        self.assertGreater(60 * 10, 4 * (2 * one * sum(1 / n for n in measure_ranks.RANKS)))
        self.assertEqual(measure_ranks.samples_for(26.5, 1.5, 64, 3.5), 16 * 50)
        self.assertEqual(measure_ranks.samples_for(2.0, 1.5, 64, 60.0), BLOCK * 16)

    def test_alternates_and_reports_ratios(self):
        self.assertEqual(measure_ranks.order(1), measure_ranks.order(0)[::-1])
        runs = [{"ranks": n, "repetition": i, "seconds": (8 + i) / n} for n in (1, 2) for i in range(3)]
        self.assertEqual(measure_ranks.ratios(runs)[1], {"ranks": 2, "speed_up": 2.0, "lowest": 2.0, "highest": 2.0, "efficiency": 1.0})


if __name__ == "__main__":
    unittest.main()
