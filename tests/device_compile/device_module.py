"""The parsed PTX of all kernels, RELUME_PTX, for several tests of a process: parsing its megabytes takes longest."""

import functools
import gc
import os
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER), str(FOLDER.parent / "ptx" / "translator")]

from parser import parse


@functools.cache
def device_text():
    return pathlib.Path(os.environ["RELUME_PTX"]).read_text(encoding="utf-8")


@functools.cache
def device_module():
    module = parse(device_text(), os.environ["RELUME_PTX"])
    gc.freeze()  # the module stays until the end, so that no later collection visits it
    return module
