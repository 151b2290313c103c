"""The package and the examples type-check."""

import os
import pathlib
import shutil
import subprocess

import pytest
import relume

EXAMPLES = sorted((pathlib.Path(__file__).resolve().parents[2] / "examples").glob("*.py"))


@pytest.mark.skipif(not shutil.which("mypy"), reason="mypy is not installed")
def test_types():
    package = pathlib.Path(relume.__file__).parent
    # Without the cache, the types of NumPy take most of the time in every run.
    cache = pathlib.Path(os.environ["RELUME_BUILD"]) / "mypy-cache"
    done = subprocess.run(["mypy", "--strict", "--ignore-missing-imports", "--no-warn-unused-ignores", "--cache-dir", cache, package, *EXAMPLES], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, done.stdout
