#!/usr/bin/env python3
"""Tests docs/farm.md against a Slurm cluster of one machine: an array job, its merge, and a render on two ranks of srun."""

import os
import pathlib
import shutil
import socket
import subprocess
import sys
import time
import unittest

import program
from program import ProgramTest, exr_pixels
from ranks import main

CONFIGURATION = """
ClusterName=relume
SlurmctldHost={host}(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmUser=root
SlurmctldPort={port}
SlurmdPort={port_of_node}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""

# slurmd initialises a plugin for control groups even if nothing uses them. That of version 2 needs systemd.
CONTROL_GROUPS = "CgroupPlugin=cgroup/v1\n"

TASK = """#!/bin/sh
#SBATCH --array=0-1
#SBATCH --output=task_%a.txt
first=$((SLURM_ARRAY_TASK_ID * 32))
{program} render cornell --width 48 --height 36 --threads 1 --sample-range $first-$((first + 31)) \\
  --resume part$SLURM_ARRAY_TASK_ID.ckpt -o part$SLURM_ARRAY_TASK_ID.exr
"""


def free_port():
    with socket.socket() as connection:
        connection.bind(("127.0.0.1", 0))
        return connection.getsockname()[1]


def install():
    """Installs Slurm where it is missing."""
    if all(shutil.which(name) for name in ("slurmctld", "slurmd", "munged", "sbatch")):
        return
    if not shutil.which("apt-get"):
        raise unittest.SkipTest("Slurm is not installed, and there is no apt-get")
    for command in (["update"], ["-y", "install", "--no-install-recommends", "slurm-wlm", "munge"]):
        done = subprocess.run(["apt-get", "-q", *command], check=False, capture_output=True, text=True, stdin=subprocess.DEVNULL,
                              env={**os.environ, "DEBIAN_FRONTEND": "noninteractive"}, timeout=600)
    if done.returncode != 0:  # without new lists, old ones may do
        raise unittest.SkipTest(f"slurm-wlm and munge cannot be installed: {done.stderr[-300:]}")


class Cluster(ProgramTest):
    def setUp(self):
        if os.geteuid() != 0:
            self.skipTest("starting Slurm needs root")
        install()
        super().setUp()
        self.cluster = self.folder / "cluster"
        for name in ("state", "spool", "munge"):
            (self.cluster / name).mkdir(parents=True)
        for folder in (self.folder, self.cluster, self.cluster / "state", self.cluster / "spool"):
            folder.chmod(0o755)  # munged and slurmctld reject other modes
        key = self.cluster / "munge" / "key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        (self.cluster / "munge").chmod(0o700)
        self.host = socket.gethostname().split(".")[0]
        (self.cluster / "slurm.conf").write_text(CONFIGURATION.format(
            host=self.host, folder=self.cluster, port=free_port(), port_of_node=free_port(), cores=os.cpu_count()))
        (self.cluster / "cgroup.conf").write_text(CONTROL_GROUPS)
        self.environment = {**os.environ, "SLURM_CONF": str(self.cluster / "slurm.conf")}
        folder = self.cluster
        self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={folder}/munge.socket", f"--pid-file={folder}/munged.pid",
                   f"--seed-file={folder}/munge.seed", f"--log-file={folder}/munged.log")
        self.wait_for((self.cluster / "munge.socket").exists, "munged")
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        self.wait_for(lambda: "idle" in self.ask("sinfo", "-h", "-o", "%T"), "slurmd")
        self.addCleanup(self.cancel_jobs)

    def start(self, *command):
        output = open(self.cluster / f"{command[0]}.out", "wb")
        self.addCleanup(output.close)
        process = subprocess.Popen(command, env=self.environment, stdin=subprocess.DEVNULL, stdout=output, stderr=output)
        self.addCleanup(self.end, process)

    @staticmethod
    def end(process):
        process.terminate()
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait(30)

    def cancel_jobs(self):
        """Ends what a failed test leaves, before its daemons end."""
        self.ask("scancel", "--signal=KILL", "--full", "--user=root")
        self.ask("scancel", "--user=root")
        end = time.monotonic() + 20
        while self.ask("squeue", "-h").strip() and time.monotonic() < end:
            time.sleep(0.2)

    def ask(self, *command, timeout=30):
        return subprocess.run(command, env=self.environment, cwd=self.folder, capture_output=True, text=True, timeout=timeout, check=False).stdout

    def wait_for(self, condition, what):
        end = time.monotonic() + 60
        while not condition():
            logs = "".join(file.read_text(errors="replace")[-500:] for kind in ("log", "out") for file in self.cluster.glob(f"*.{kind}"))
            self.assertLess(time.monotonic(), end, f"{what} does not start: {logs}")
            time.sleep(0.2)

    def test_two_tasks_of_an_array_and_their_merge(self):
        (self.folder / "job.sh").write_text(TASK.format(program=program.PROGRAM))
        done = subprocess.run(["sbatch", "--wait", "job.sh"], env=self.environment, cwd=self.folder, capture_output=True, text=True, timeout=300, check=False)
        tasks = "".join(file.read_text() for file in sorted(self.folder.glob("task_*.txt")))
        self.assertEqual(done.returncode, 0, done.stderr + tasks)
        self.succeed("merge", "part0.exr", "part1.exr", "-o", "out.exr")
        self.succeed("render", "cornell", "--width", "48", "--height", "36", "--spp", "64", "-o", "whole.exr")
        self.assertTrue(exr_pixels(self.folder / "out.exr") == exr_pixels(self.folder / "whole.exr"))

    def test_ranks_of_srun(self):
        if not (pathlib.Path(program.PROGRAM).resolve().parent / "relume-mpi-mpich.so").exists():
            self.skipTest("relume was built without relume-mpi-mpich.so")
        if (os.cpu_count() or 1) < 2:
            self.skipTest("needs two processors")
        kinds = subprocess.run(["srun", "--mpi=list"], env=self.environment, capture_output=True, text=True, timeout=30, check=False)
        if "pmi2" not in kinds.stdout + kinds.stderr:
            self.skipTest("this Slurm has no plugin for PMI-2")
        look = ["render", "cornell", "--width", "48", "--height", "36", "--threads", "1", "--spp", "64"]
        done = subprocess.run(["srun", "--mpi=pmi2", "-n", "2", program.PROGRAM, *look, "-o", "out.exr"], env=self.environment, cwd=self.folder,
                              capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.succeed(*look, "-o", "whole.exr")
        self.assertTrue(exr_pixels(self.folder / "out.exr") == exr_pixels(self.folder / "whole.exr"))


if __name__ == "__main__":
    print(f"runs {program.PROGRAM}", file=sys.stderr)
    main()
