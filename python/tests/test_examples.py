"""The examples run as their page says, and type-check."""

import os
import pathlib
import re
import shutil
import subprocess
import sys

import pytest
import relume

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def run(script, folder, *arguments):
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder)}
    done = subprocess.run([sys.executable, script, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_page_lists_all_examples():
    page = (ROOT / "examples/README.md").read_text()
    assert sorted(re.findall(r"^\| `(\w+\.py)", page, re.MULTILINE)) == [example.name for example in EXAMPLES]
    assert len(EXAMPLES) == 5


def test_first_image(tmp_path):
    assert "64 samples per pixel, ended by: samples" in run(ROOT / "examples/first_image.py", tmp_path)
    assert relume.read_image(tmp_path / "image.png").shape == (180, 320, 3)


def test_equal_time(tmp_path):
    output = run(ROOT / "examples/equal_time.py", tmp_path)
    scores = {name: float(mse) for name, mse in re.findall(r"^(\S+): MSE (\S+),", output, re.MULTILINE)}
    assert scores["vlc"] < scores["uniform"]
    assert "<html" in (tmp_path / "equal_time.html").read_text()


def test_ghosting(tmp_path):
    output = run(ROOT / "examples/ghosting.py", tmp_path)
    figures = [[float(n) for n in line] for line in re.findall(r"MSE of a frame (\S+), of which bias (\S+)", output)]
    (noise, bias), (_, backward), (forward_noise, _) = figures
    assert forward_noise < noise
    assert abs(bias) < 0.05 * noise, "images without a history are unbiased"
    assert backward > 0


def test_quadtrees(tmp_path):
    output = run(ROOT / "examples/quadtrees.py", tmp_path)
    assert "97 leaves" in output
    assert relume.read_image(tmp_path / "quadtrees.png").max() > 0


def test_denoiser(tmp_path):
    before, after = (float(mse) for mse in re.findall(r"MSE (\S+)", run(ROOT / "examples/denoiser.py", tmp_path)))
    assert after < 0.6 * before


@pytest.mark.skipif(not shutil.which("mypy"), reason="mypy is not installed")
def test_types():
    package = pathlib.Path(relume.__file__).parent
    done = subprocess.run(["mypy", "--strict", "--ignore-missing-imports", "--no-warn-unused-ignores", "--cache-dir", os.devnull, package, *EXAMPLES], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, done.stdout
