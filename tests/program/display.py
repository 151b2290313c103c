#!/usr/bin/env python3
"""A virtual display. display.py [--screen WxHxD] COMMAND...: runs COMMAND on a virtual display and returns its exit
code."""

import argparse
import contextlib
import ctypes
import os
import select
import shutil
import signal
import subprocess
import sys

SECONDS_TO_START = 60
SECONDS_TO_END = 20
PR_SET_PDEATHSIG = 1  # linux/prctl.h


def end_with_parent():
    """Makes Linux end the server even if its parent is killed."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


def read_line(descriptor, seconds):
    """Bytes received within `seconds`, up to a newline; without one if the other end closed or time ran out."""
    line = b""
    while not line.endswith(b"\n") and select.select([descriptor], [], [], seconds)[0]:
        block = os.read(descriptor, 64)
        if not block:
            break
        line += block
    return line.decode()


@contextlib.contextmanager
def virtual_display(screen="1600x1000x24"):
    """Name of an Xvfb server, such as ":1", that accepts connections on entry and has ended on exit."""
    reader, writer = os.pipe()
    try:
        # Without -noreset, the server restarts after its last client and may reject the next one meanwhile.
        command = ["Xvfb", "-displayfd", str(writer), "-screen", "0", screen, "-nolisten", "tcp", "-noreset"]
        server = subprocess.Popen(command, pass_fds=[writer], preexec_fn=end_with_parent, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    finally:
        os.close(writer)
    try:
        number = read_line(reader, SECONDS_TO_START).strip()
        if not number:
            raise RuntimeError(f"Xvfb opened no display in {SECONDS_TO_START} s; run `{' '.join(command[:1] + command[3:])}` to see why")
        yield f":{number}"
    finally:
        os.close(reader)
        server.terminate()
        try:
            server.wait(SECONDS_TO_END)
        except subprocess.TimeoutExpired:
            server.kill()
            server.wait()


def is_available():
    """Whether a display or Xvfb exists."""
    return bool(os.environ.get("DISPLAY")) or shutil.which("Xvfb") is not None


@contextlib.contextmanager
def any_display():
    """Sets DISPLAY to a virtual display, unless a display exists."""
    if os.environ.get("DISPLAY"):
        yield
        return
    with virtual_display() as name:
        os.environ["DISPLAY"] = name
        try:
            yield
        finally:
            del os.environ["DISPLAY"]


def main():
    parser = argparse.ArgumentParser(description="Runs a command on a display without a screen.")
    parser.add_argument("--screen", default="1600x1000x24", help="width x height x bits of a pixel")
    parser.add_argument("command", nargs=argparse.REMAINDER)
    arguments = parser.parse_args()
    if not arguments.command:
        parser.error("a command is missing")
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))
    with virtual_display(arguments.screen) as name:
        done = subprocess.run(arguments.command, env=dict(os.environ, DISPLAY=name), check=False)
    return done.returncode if done.returncode >= 0 else 128 - done.returncode


if __name__ == "__main__":
    sys.exit(main())
