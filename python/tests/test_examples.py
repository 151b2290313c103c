"""Runs the examples as their page says, some with fewer samples."""

import os
import pathlib
import re
import subprocess
import sys

import relume

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def run(script, folder, *arguments):
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder)}
    done = subprocess.run([sys.executable, script, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def with_replacements(folder, name, *changes):
    """Returns a copy of an example with fewer samples. Its reference still has far less noise than the images compared with it. Small images
    are rendered by one thread, since other tests run beside it."""
    code = (ROOT / "examples" / name).read_text(encoding="utf-8")
    for before, after in changes:
        assert code.count(before) == 1, before
        code = code.replace(before, after)
    (folder / name).write_text(code, encoding="utf-8")
    return folder / name


def test_the_page_lists_all_examples():
    page = (ROOT / "examples/README.md").read_text()
    assert sorted(re.findall(r"^\| `(\w+\.py)", page, re.MULTILINE)) == [example.name for example in EXAMPLES]
    assert len(EXAMPLES) == 5


def test_first_image(tmp_path):
    script = with_replacements(tmp_path, "first_image.py", ("320, 180", "80, 45"))
    assert "64 samples per pixel, ended by: samples" in run(script, tmp_path)
    assert relume.read_image(tmp_path / "image.png").shape == (45, 80, 3)


def test_equal_time(tmp_path):
    # A quarter of the pixels in half of the time: twice as many samples per pixel. A pause may halve those of a contender. In the
    # stored results, uniform has 377 times the product of MSE and time of vlc in this scene (docs/guarantees.md). The other
    # contenders are compared nowhere below.
    script = with_replacements(tmp_path, "equal_time.py", ("repetitions=5", "repetitions=3"), ("reference_samples=256", "reference_samples=64"),
                               ("width=160, height=90", "width=80, height=45"), ('budget="300ms"', 'budget="150ms"'),
                               ('    "power": {"lights": "power"},\n', ""), ('    "light-tree": {"lights": "light-tree"},\n', ""))
    output = run(script, tmp_path)
    scores = {name: float(mse) for name, mse in re.findall(r"^(\S+): MSE (\S+),", output, re.MULTILINE)}
    assert scores["vlc"] < scores["uniform"]
    assert "<html" in (tmp_path / "equal_time.html").read_text()


def test_ghosting(tmp_path):
    # The reference's noise adds 0.8 % of a frame's, of which the bound below allows 5 %.
    script = with_replacements(tmp_path, "ghosting.py", ("still.render(2048)", "still.render(128)"), ("seed=1000)", "seed=1000, threads=1)"),
                               ('{"seed": seed,', '{"threads": 1, "seed": seed,'))
    output = run(script, tmp_path)
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
    # The reference's noise is a sixteenth of that of four samples, and is part of both errors.
    script = with_replacements(tmp_path, "denoiser.py", ("reference.render(1024)", "reference.render(64)"), ("seed=seed)", "seed=seed, threads=1)"))
    before, after = (float(mse) for mse in re.findall(r"MSE (\S+)", run(script, tmp_path)))
    assert after < 0.6 * before
