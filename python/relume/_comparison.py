"""Comparisons of techniques with a reference, and experiments from papers."""

import contextlib
import html
import os
import pathlib
import re
import tempfile
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._errors import Error
from ._image import Image, Path, as_image, write_exr
from ._names import suggestion
from ._progress import progress_bar
from ._scene import Scene
from ._settings import Value, presets, texts

Contender = Union[str, Mapping[str, Value], None]
_SECONDS = {"ms": 1e-3, "s": 1.0, "m": 60.0, "min": 60.0, "h": 3600.0}


class Comparison(list[dict[str, Any]]):
    """One record per contender: name, mse, rel_mse, mape, flip, temporal_error, samples (per pixel), time_s, mses (one per
    repetition) and image."""

    reference: Image
    """The image that the errors refer to."""
    reference_mse: float
    """Expected error of the reference itself; 0: unknown."""
    notes: list[str]
    """Limits of the comparison."""
    html: str
    """The page that `relume compare` writes."""
    json: str
    csv: str

    def save(self, file: Path) -> None:
        """Writes the page as HTML, or the scores as .json or .csv."""
        suffix = pathlib.Path(file).suffix
        text = {".json": self.json, ".csv": self.csv}.get(suffix, self.html)
        pathlib.Path(file).write_text(text, encoding="utf-8")

    def to_pandas(self) -> Any:
        """A pandas.DataFrame with the numbers."""
        import pandas

        return pandas.DataFrame(self._numbers())

    def _numbers(self) -> list[dict[str, Any]]:
        return [{k: v for k, v in record.items() if k not in ("image", "mses")} for record in self]

    def _repr_html_(self) -> str:
        rows = self._numbers()
        head = "".join(f"<th>{name}</th>" for name in rows[0])
        cells = [[value if isinstance(value, str) else f"{value:.4g}" for value in row.values()] for row in rows]
        body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in cells)
        return f"<table><tr>{head}</tr>{body}</table>"

    def __repr__(self) -> str:
        lines = [f"{record['name']}: MSE {record['mse']:.3g}, {record['samples']:.0f} samples, {record['time_s']:.3g} s"
                 for record in self]
        return "\n".join(lines)


def seconds(duration: Union[str, float]) -> float:
    """Seconds of a number, or of a text such as "500ms", "2s" or "1m"."""
    if not isinstance(duration, str):
        return float(duration)
    match = re.fullmatch(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(ms|s|m|min|h)\s*", duration)
    if not match:
        raise Error(f"'{duration}' is not a duration; give seconds, or a text such as '500ms', '2s' or '1m'")
    return float(match[1]) * _SECONDS[match[2]]


def _folder(given: Optional[Path]) -> str:
    """Folder of rendered references: the given one, or the program's in $XDG_CACHE_HOME/relume or ~/.cache/relume."""
    if given is not None:
        return os.fspath(given)
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    folder = os.path.join(base, "relume", "references")
    os.makedirs(folder, exist_ok=True)
    return folder


def compare(scene: Scene, contenders: Mapping[str, Contender], *, budget: Union[str, float, None] = None, samples: int = 64,
            width: int = 320, height: int = 180, repetitions: int = 5, times_s: Optional[list[float]] = None,
            reference: Union[Path, NDArray[Any], None] = None, reference_samples: int = 1024, progress: bool = False,
            reference_folder: Optional[Path] = None, **settings: Value) -> Comparison:
    """Renders contenders with several seeds and measures their errors.

    `contenders` maps names to settings: a dict (its entry "preset" names a preset), the name of a preset, or None for the
    defaults. In contrast to Session, contenders use no preset unless they name one. With `budget` (seconds, or a text such
    as "2s"), each contender gets that time in each repetition, otherwise `samples` per pixel. Further keyword arguments are
    settings of all contenders. `reference` is an EXR file or an image; without one, a reference of `reference_samples` per
    pixel is rendered and kept in `reference_folder`, by default that of the program. `times_s`: scene times of an animation.
    Raises Error for unknown presets or settings, invalid values, and a reference of another size.

    >>> scores = relume.compare(relume.builtin("cornell"), {"uniform": {"lights": "uniform"}, "vlc": {"lights": "vlc"}})
    >>> min(scores, key=lambda score: score["mse"])["name"]
    """
    request: dict[str, Any] = {
        "scene_name": scene.name or "scene",
        "contenders": [(name, *_contender(value)) for name, value in contenders.items()],
        "settings": [("width", str(width)), ("height", str(height)), *texts(settings)],
        "samples": samples,
        "budget_s": 0.0 if budget is None else seconds(budget),
        "repetitions": repetitions,
        "times_s": times_s or [],
        "reference_samples": reference_samples,
    }
    if not contenders:
        raise Error("there is nothing to compare; name at least one contender")
    with _reference_file(reference) as file, _stages(progress) as report:
        request["reference_file"] = file
        request["cache_folder"] = "" if file else _folder(reference_folder)
        result = _core.compare(scene, request, report)
    if result is None:
        raise KeyboardInterrupt
    comparison = Comparison({**score, "image": as_image(score["image"])} for score in result["scores"])
    comparison.reference = as_image(result["reference"])
    for name in ("reference_mse", "notes", "html", "json", "csv"):
        setattr(comparison, name, result[name])
    return comparison


def _contender(value: Contender) -> tuple[str, list[tuple[str, str]]]:
    """Preset ("": none), and texts of settings."""
    if value is None or value == "default":
        return "", []
    if isinstance(value, str):
        if value not in presets():
            raise Error(f"there is no preset '{value}'{suggestion(value, presets())}", "not-found")
        return value, []
    own = dict(value)
    preset = own.pop("preset", None)
    return "" if preset is None else str(preset), texts(own)


@contextlib.contextmanager
def _reference_file(reference: Union[Path, NDArray[Any], None]) -> Iterator[str]:
    if reference is None:
        yield ""
    elif isinstance(reference, np.ndarray):
        with tempfile.TemporaryDirectory(prefix="relume-") as folder:
            file = os.path.join(folder, "reference.exr")
            write_exr(file, reference)
            yield file
    else:
        yield os.fspath(reference)


@contextlib.contextmanager
def _stages(show: bool) -> Iterator[Optional[Callable[[str, float], None]]]:
    """A progress function that shows one bar per stage."""
    if not show:
        yield None
        return
    with contextlib.ExitStack() as bars:
        shown: dict[str, Any] = {}

        def report(stage: str, fraction: float) -> None:
            if stage not in shown:
                shown[stage] = bars.enter_context(progress_bar(100, f"% {stage}"))
            shown[stage].update(int(100 * fraction) - shown[stage].n)

        yield report


class ExperimentReport:
    """Results of an experiment: the paper's claims beside the measurements."""

    def __init__(self, result: Mapping[str, Any]) -> None:
        self.claims: list[dict[str, str]] = result["claims"]
        self.seconds: float = result["seconds"]
        self.json: str = result["json"]
        self.html: str = result["html"]

    def save(self, file: Path) -> None:
        """Writes the page as HTML, or the measurements as .json."""
        text = self.json if pathlib.Path(file).suffix == ".json" else self.html
        pathlib.Path(file).write_text(text, encoding="utf-8")

    def __repr__(self) -> str:
        return "\n".join(f"{claim['id']}: {claim['verdict']}" for claim in self.claims)


def experiments() -> dict[str, str]:
    """Names of the experiments, with a line on each."""
    return _core.experiments()


def experiment(name: str, quick: bool = False, *, scenes: Optional[Path] = None, reference_folder: Optional[Path] = None,
               device: str = "cpu", progress: bool = False) -> ExperimentReport:
    """Runs an experiment; many take hours unless `quick`. `scenes`: folder that contains sponza/sponza.gltf. `device`: as
    the setting of sessions. Raises Error for an unknown name, if the experiment needs that folder and it is missing, and if
    the device is unknown or cannot be used."""
    if name not in experiments():
        raise Error(f"there is no experiment '{name}'{suggestion(name, experiments())}", "not-found")
    with _stages(progress) as report:
        result = _core.experiment(name, quick, _folder(reference_folder), os.fspath(scenes) if scenes is not None else "", device, report)
    if result is None:
        raise KeyboardInterrupt
    return ExperimentReport(result)
