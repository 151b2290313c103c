"""The code of docs/python.md and of README.md runs."""

import pathlib
import re
import tomllib

import relume

ROOT = pathlib.Path(__file__).resolve().parents[2]


def blocks(page):
    return re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def test_the_page_runs_from_top_to_bottom(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    names = {}
    code = blocks("docs/python.md")
    assert len(code) > 6
    for block in code:
        exec(compile(block, "docs/python.md", "exec"), names)
    assert "not-found - did you mean 'psf_cell_size'?" in capsys.readouterr().out
    for file in ("cornell.png", "tile.glb", "comparison.html"):
        assert (tmp_path / file).stat().st_size > 0


def test_the_readme_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (code,) = blocks("README.md")
    relume.builtin("cornell").save("scene.glb")
    shortened = code.replace("640, 360", "64, 36").replace(
        'budget="2s"', 'budget="100ms", width=64, height=36, repetitions=1, reference_samples=64')
    exec(compile(shortened, "README.md", "exec"), {})
    assert (tmp_path / "out.png").exists()


def test_the_package_has_the_version_of_the_library():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["version"] == relume.__version__
