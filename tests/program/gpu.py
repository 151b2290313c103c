"""Runs programs with the stub driver of tests/cuda in place of NVIDIA's. RELUME_STUB_DRIVER_FOLDER is its folder."""

import os

STUB = os.environ["RELUME_STUB_DRIVER_FOLDER"]


def environment(settings="", driver_folder=STUB, base=os.environ):
    """The variables of `base`, for a program that finds the driver in a folder. tests/cuda/README.md lists the stub's settings."""
    return {**base, "LD_LIBRARY_PATH": str(driver_folder), "RELUME_STUB_DRIVER": settings}


def logging(file, settings="", base=os.environ):
    """The same, for launches_in()."""
    return environment(f"{settings} log={file}", base=base)


def launches_in(file):
    """Names of the launched kernels, in order."""
    return file.read_text().splitlines()
