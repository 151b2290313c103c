#!/usr/bin/env python3
"""Tests of several ranks that take minutes, and tests that need privileges."""

import math
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import time

import program
from program import exr_pixels
from ranks import RanksTest, main

PAIRS = 8
T_QUANTILE = 2.365  # 97.5 % of Student's t with PAIRS - 1 degrees of freedom

AGENT = """#!/bin/sh
# Open MPI's launch agent: HOST COMMAND…
host=$1
shift
exec ip netns exec $(cat {folder}/$host) /bin/sh -c "$*"
"""


def in_namespace(name, *command):
    subprocess.run(["ip", "-n", name, *command], check=True, capture_output=True, timeout=30)


class Hosts(RanksTest):
    """Two network namespaces, joined by a cable, as two hosts."""

    def setUp(self):
        super().setUp()
        if not shutil.which("ip"):
            self.skipTest("ip is not installed")
        tag = f"{os.getpid() % 10000}"
        self.spaces = [f"rla{tag}", f"rlb{tag}"]
        self.addresses = ["10.213.77.1", "10.213.77.2"]
        for space in self.spaces:
            done = subprocess.run(["ip", "netns", "add", space], check=False, capture_output=True, text=True, timeout=30)
            if done.returncode != 0:
                self.skipTest(f"the system permits no network namespace: {done.stderr.strip()}")
            self.addCleanup(subprocess.run, ["ip", "netns", "del", space], check=False, timeout=30)
        cable = ["ip", "link", "add", "cable", "netns", self.spaces[0], "type", "veth", "peer", "name", "cable", "netns", self.spaces[1]]
        done = subprocess.run(cable, check=False, capture_output=True, text=True, timeout=30)
        if done.returncode != 0:
            self.skipTest(f"the system has no pairs of virtual network devices: {done.stderr.strip()}")
        for space, address in zip(self.spaces, self.addresses):
            in_namespace(space, "addr", "add", f"{address}/24", "dev", "cable")
            in_namespace(space, "link", "set", "cable", "up")
            in_namespace(space, "link", "set", "lo", "up")
            (self.folder / address).write_text(space)
        agent = self.folder / "agent"
        agent.write_text(AGENT.format(folder=self.folder))
        agent.chmod(0o755)
        self.addCleanup(self.end_daemons)

    def end_daemons(self):
        """Ends what still runs in the namespaces: the daemon of a host that was cut off."""
        for space in self.spaces:
            for number in subprocess.run(["ip", "netns", "pids", space], check=False, capture_output=True, text=True, timeout=30).stdout.split():
                try:
                    os.kill(int(number), 9)
                except OSError:
                    pass

    def command(self, ranks, *arguments):
        network = "10.213.77.0/24"
        return ["ip", "netns", "exec", self.spaces[0], self.mpirun, "--host", ",".join(f"{a}:1" for a in self.addresses),
                "--mca", "plm_rsh_agent", str(self.folder / "agent"), "--mca", "btl", "tcp,self", "--mca", "btl_tcp_if_include", network,
                "--mca", "oob_tcp_if_include", network, "--wdir", str(self.folder), "-n", str(ranks), program.PROGRAM, *map(str, arguments)]

    def test_a_host_that_is_cut_off(self):
        look = ["render", "cornell", "--width", "160", "--height", "120", "--threads", "1", "--spp", "1000000"]
        process, _ = self.start_on_ranks(2, *look, "-o", "out.exr", "--resume", "out.ckpt", "--checkpoint-interval", "1s")
        self.wait_for((self.folder / "out.ckpt").exists, "a checkpoint")
        in_namespace(self.spaces[1], "link", "set", "cable", "down")
        start = time.monotonic()
        self.assertNotEqual(process.wait(60), 0)
        print(f"ended {time.monotonic() - start:.0f} s after the cable was cut")
        self.assertIn("cannot be reached any more; continue from out.ckpt", self.errors())
        done = self.succeed("merge", "out.ckpt", "-o", "so_far.exr")
        look[-1] = str(int(re.search(r"with (\d+) samples per pixel", done.stderr)[1]) + 200)
        self.succeed(*look, "-o", "out.exr", "--resume", "out.ckpt", timeout=1200)
        self.succeed(*look, "-o", "whole.exr", timeout=1200)
        self.assertTrue(exr_pixels(self.folder / "out.exr") == exr_pixels(self.folder / "whole.exr"))


class Times(RanksTest):
    """Two ranks with one thread each against one rank with two threads."""

    def test_ranks_cost_at_most_five_percent(self):
        if (os.cpu_count() or 1) < 2:
            self.skipTest("needs two processors")
        scene = pathlib.Path(os.environ.get("RELUME_SCENES", "")) / "sponza" / "sponza.gltf"
        if "RELUME_SCENES" not in os.environ or not scene.exists():
            self.skipTest("RELUME_SCENES names no folder with Sponza")
        # Each rank loads Sponza with its one thread, which costs a second more.
        look = ["render", str(scene), "--width", "640", "--height", "360", "--spp", "256", "--quiet"]

        def seconds(run):
            start = time.monotonic()
            run()
            return time.monotonic() - start

        def one_rank():
            self.succeed(*look, "--threads", "2", "-o", "one.exr", timeout=1500)

        def two_ranks():
            self.succeed_on_ranks(2, *look, "--threads", "1", "-o", "two.exr", timeout=1500)

        logarithms = []
        for pair in range(PAIRS):
            order = (one_rank, two_ranks) if pair % 2 == 0 else (two_ranks, one_rank)
            times = {run: seconds(run) for run in order}
            logarithms.append(math.log(times[two_ranks] / times[one_rank]))
            print(f"pair {pair + 1} of {PAIRS}: {times[two_ranks]:.1f} s and {times[one_rank]:.1f} s", flush=True)
            self.assertTrue(exr_pixels(self.folder / "two.exr") == exr_pixels(self.folder / "one.exr"))
        mean = statistics.mean(logarithms)
        half = T_QUANTILE * statistics.stdev(logarithms) / math.sqrt(PAIRS)
        low, middle, high = (math.exp(x) for x in (mean - half, mean, mean + half))
        print(f"time of two ranks over one rank: {middle:.3f} ({low:.3f} to {high:.3f})")
        self.assertLessEqual(high, 1.05)


if __name__ == "__main__":
    main()
