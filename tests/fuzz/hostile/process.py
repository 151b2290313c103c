"""Runs the program once and measures it with its children."""

import dataclasses
import os
import pathlib
import signal
import subprocess
import time

LONGEST_PAUSE_S = 0.02
MEMORY_INTERVAL_S = 0.05
READ_BYTES = 1 << 20
PAGE_BYTES = os.sysconf("SC_PAGESIZE")


@dataclasses.dataclass
class Run:
    exit_code: int  # negative: signal that ended the process
    seconds: float
    memory: int  # in bytes: the largest process, or the sum of concurrent ones
    hung: bool
    too_large: bool
    left_behind: bool  # a process of its group is still running
    stdout: bytes
    stderr: bytes


def _resident(process):
    try:
        return int(pathlib.Path(f"/proc/{process}/statm").read_text(encoding="ascii").split()[1]) * PAGE_BYTES
    except (OSError, IndexError, ValueError):
        return 0


def _children(process):
    found = []
    try:
        for thread in os.listdir(f"/proc/{process}/task"):
            found += pathlib.Path(f"/proc/{process}/task/{thread}/children").read_text(encoding="ascii").split()
    except OSError:
        pass
    return found


def _tree_memory(process):
    return _resident(process) + sum(_tree_memory(child) for child in _children(process))


def _end_group(process):
    try:
        os.killpg(process, signal.SIGKILL)
        return True
    except ProcessLookupError:
        return False


def run(command, folder, environment, stdout, stderr, wall_s, memory_bytes):
    """Waits for `command`; `stdout` and `stderr` are files for its output. ru_maxrss gives the largest of the process
    and its finished children; /proc gives the sum of running ones."""
    with open(stdout, "wb") as out, open(stderr, "wb") as err:
        began = time.monotonic()
        child = subprocess.Popen(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=err, start_new_session=True)
    peak, hung, too_large, pause, looked = 0, False, False, 0.001, began
    while True:
        ended, status, usage = os.wait4(child.pid, os.WNOHANG)
        now = time.monotonic()
        if ended:
            break
        if now - looked >= MEMORY_INTERVAL_S:
            looked = now
            peak = max(peak, _tree_memory(child.pid))
            hung, too_large = now - began > wall_s, peak > memory_bytes
            if hung or too_large:
                os.killpg(child.pid, signal.SIGKILL)
                _, status, usage = os.wait4(child.pid, 0)
                break
        time.sleep(pause)
        pause = min(1.5 * pause, LONGEST_PAUSE_S)
    child.returncode = os.waitstatus_to_exitcode(status)
    peak = max(peak, usage.ru_maxrss * 1024)
    left_behind = _end_group(child.pid) and not hung and not too_large
    texts = [pathlib.Path(file).read_bytes()[:READ_BYTES] if os.path.isfile(file) else b"" for file in (stdout, stderr)]
    return Run(child.returncode, now - began, peak, hung, too_large or peak > memory_bytes, left_behind, *texts)
