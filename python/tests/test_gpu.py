"""Sessions on a GPU: the stub driver of tests/cuda, which the loader finds where a process starts, executes the device code."""

import os
import subprocess
import sys

import pytest

STUB = os.environ.get("RELUME_STUB_DRIVER_FOLDER")
pytestmark = pytest.mark.skipif(not STUB, reason="the build has no device code")


def run(code, settings=""):
    """Output of Python code with the stub driver."""
    environment = dict(os.environ, LD_LIBRARY_PATH=STUB, RELUME_STUB_DRIVER=settings)
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_images_have_the_bits_of_the_host(tmp_path):
    code = """
import numpy as np
import relume
images = []
for values in ({"device": "cuda"}, {"device": "cpu", "accel": "bvh"}):
    session = relume.Session(relume.builtin("cornell"), 24, 18, preset=None, threads=1, **values)
    session.render(2)
    images.append(session.image)
np.testing.assert_array_equal(*images)
assert images[0].max() > 0
"""
    log = tmp_path / "log.txt"
    run(code, f"log={log}")
    assert "PathKernel" in log.read_text()


def test_a_gpu_that_is_lost_raises_an_error():
    code = """
import relume
session = relume.Session(relume.builtin("cornell"), 24, 18, preset=None, threads=1, device="cuda")
try:
    session.render(100)
except relume.Error as error:
    print(error.code, error)
"""
    assert run(code, "lose=20").startswith("device Stub GPU 0 (cuda:0) failed in or after the launch of '")


def test_a_gpu_that_cannot_be_used_raises_an_error():
    code = """
import relume
try:
    relume.Session(relume.builtin("cornell"), 24, 18, device="cuda")
except relume.Error as error:
    print(error.code, error)
"""
    assert run(code, "version=9020").startswith("device the CUDA driver supports CUDA 9.2, but relume needs 10.0")
