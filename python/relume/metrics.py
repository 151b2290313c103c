"""Error metrics of an image against a reference: means over all pixels and channels of linear values.

Pixels that are not finite in either image are excluded. Both arguments have the shape (height, width, 3).
Functions raise Error for other shapes, and if the shapes differ.
"""

from typing import Any

from numpy.typing import NDArray

from . import _core


def mse(a: Any, b: Any) -> float:
    """(a - b)²."""
    return float(_core.metrics(a, b, False)["mse"])


def rel_mse(a: Any, b: Any) -> float:
    """(a - b)² / (b² + 0.01)."""
    return float(_core.metrics(a, b, False)["rel_mse"])


def mae(a: Any, b: Any) -> float:
    """|a - b|."""
    return float(_core.metrics(a, b, False)["mae"])


def mape(a: Any, b: Any) -> float:
    """|a - b| / (|b| + 0.01)."""
    return float(_core.metrics(a, b, False)["mape"])


def flip(a: Any, b: Any) -> float:
    """Mean visible difference in [0, 1] of display-linear values ([Andersson20]), clamped to [0, 1]."""
    return float(_core.metrics(a, b, True)["flip"])


def flip_map(a: Any, b: Any) -> NDArray[Any]:
    """Visible difference of each pixel, (height, width), in [0, 1]."""
    return _core.flip_map(a, b)


def measure(a: Any, b: Any) -> dict[str, float]:
    """All of these by name, and the numbers of compared and excluded pixels."""
    return _core.metrics(a, b, True)
