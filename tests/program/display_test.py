#!/usr/bin/env python3
"""Tests that the virtual display passes exit codes on and ends with its user in all cases."""

import contextlib
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

DISPLAY = pathlib.Path(__file__).with_name("display.py")
SKIPPED = 77  # to ctest


def on_display(*command):
    return [sys.executable, str(DISPLAY), *command]


# Printed by the command: the server is the first child of its parent.
PRINT_SERVER = "read server others < /proc/$PPID/task/$PPID/children; echo $server"


def is_running(process):
    try:
        return pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(") ", 1)[1][0] != "Z"
    except FileNotFoundError:
        return False


class Display(unittest.TestCase):
    def assert_ends(self, process, seconds=30):
        end = time.monotonic() + seconds
        while is_running(process) and time.monotonic() < end:
            time.sleep(0.05)
        self.assertFalse(is_running(process), "the server stays")

    def test_exit_codes_are_those_of_the_command(self):
        for code in (0, 3, 5):
            done = subprocess.run(on_display("sh", "-c", f"exit {code}"), check=False, timeout=120)
            self.assertEqual(done.returncode, code)

    def test_the_server_ends_with_the_command(self):
        done = subprocess.run(on_display("sh", "-c", f"{PRINT_SERVER}; cat /proc/$server/comm; echo $DISPLAY"), capture_output=True, text=True, check=True, timeout=120)
        server, name, display = done.stdout.split()
        self.assertEqual(name, "Xvfb")
        self.assertRegex(display, r"^:\d+$")
        self.assertFalse(is_running(int(server)))

    def test_the_server_ends_with_its_parent(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            process = subprocess.Popen(on_display("sh", "-c", f"{PRINT_SERVER}; exec sleep 60"), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, start_new_session=True)
            self.addCleanup(process.stdout.close)
            server = int(process.stdout.readline())
            self.assertTrue(is_running(server))
            process.send_signal(number)
            process.wait(60)
            self.assert_ends(server)
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)  # the command, which nothing else ends


if __name__ == "__main__":
    if shutil.which("Xvfb") is None:
        print("no Xvfb")
        sys.exit(SKIPPED)
    unittest.main()
