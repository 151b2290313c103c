"""Runs the program under mpirun of Open MPI and MPICH."""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest
import uuid

import program

SKIPPED = 77  # ctest's exit code for skipped tests
FOLDER = pathlib.Path(program.PROGRAM).resolve().parent
# Tests run as root in containers, on machines with fewer processors than ranks. Ranks of small images spin less when they yield.
OPEN_MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
            "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_hwloc_base_binding_policy": "none"}


def launcher(library):
    """The mpirun of a library; skips the test if it or relume's plugin is missing."""
    if os.environ.get("RELUME_SANITIZED"):
        raise unittest.SkipTest("MPI libraries leak memory, which sanitizers report")
    plugin = FOLDER / f"relume-mpi-{library}.so"
    if not plugin.exists():
        raise unittest.SkipTest(f"relume was built without {plugin.name}")
    found = shutil.which(f"mpirun.{library}")
    if not found:
        raise unittest.SkipTest(f"mpirun.{library} is not installed")
    return found


def environment(**variables):
    return {**os.environ, **OPEN_MPI, **variables}


class RanksTest(program.ProgramTest):
    library = "openmpi"

    def setUp(self):
        self.mpirun = launcher(self.library)
        super().setUp()

    def command(self, ranks, *arguments):
        return [self.mpirun, "-n", str(ranks), program.PROGRAM, *map(str, arguments)]

    def on_ranks(self, ranks, *arguments, timeout=120, **variables):
        mark = uuid.uuid4().hex
        try:
            return subprocess.run(self.command(ranks, *arguments), cwd=self.folder, env=environment(RELUME_TEST_MARK=mark, **variables), timeout=timeout,
                                  capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)
        finally:
            end_processes(mark)

    def succeed_on_ranks(self, ranks, *arguments, **options):
        done = self.on_ranks(ranks, *arguments, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def start_on_ranks(self, ranks, *arguments, **variables):
        """The process of mpirun, and the text by which the environments of its ranks are known."""
        mark = uuid.uuid4().hex
        errors = open(self.folder / "errors.txt", "wb")
        self.addCleanup(errors.close)
        process = subprocess.Popen(self.command(ranks, *arguments), cwd=self.folder, env=environment(RELUME_TEST_MARK=mark, **variables),
                                   stdin=subprocess.DEVNULL, stdout=errors, stderr=errors, start_new_session=True)
        self.addCleanup(process.wait, 30)
        self.addCleanup(end_processes, mark)
        return process, mark

    def errors(self):
        return (self.folder / "errors.txt").read_text(errors="replace")

    def wait_for(self, condition, what, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, f"{what} within {seconds} s; {self.errors()}")
            time.sleep(0.02)


def marked_processes(mark):
    """Environments of the processes with this mark, by their number."""
    processes = {}
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            variables = set((folder / "environ").read_bytes().split(b"\0"))
        except OSError:
            continue
        if f"RELUME_TEST_MARK={mark}".encode() in variables:
            processes[int(folder.name)] = variables
    return processes


def end_processes(mark):
    """Ends mpirun and ranks that still run, as after a time-out, which ends mpirun only."""
    for number in marked_processes(mark):
        try:
            os.kill(number, signal.SIGKILL)
        except OSError:
            pass  # ended meanwhile


def rank_process(mark, rank):
    """Number of the process of a rank; None before it has started."""
    ranks = {f"{name}={rank}".encode() for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK")}
    return next((number for number, variables in marked_processes(mark).items() if variables & ranks), None)


def cpu_seconds(number):
    """Processor time of a process; 0 after its end."""
    try:
        fields = pathlib.Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main():
    """As unittest.main(), but ends with SKIPPED if no test ran."""
    done = unittest.main(module="__main__", exit=False, verbosity=2).result
    if done.wasSuccessful() and done.testsRun == len(done.skipped):
        sys.exit(SKIPPED)
    sys.exit(not done.wasSuccessful())
