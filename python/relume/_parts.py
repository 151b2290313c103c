"""The parts of scenes as values: comparing, copying, pickling, printing."""

from typing import Any

import numpy as np

from . import _core

TYPES = (_core.Texture, _core.TextureRef, _core.Material, _core.MorphTarget, _core.Mesh, _core.Skin, _core.Light, _core.SunSky,
         _core.Environment, _core.Camera, _core.CameraPose, _core.Transform, _core.Node, _core.AnimationChannel,
         _core.ParameterChannel)


def names(kind: type) -> list[str]:
    """The attributes of a part, in the order in which they can be set."""
    return [name for name, value in vars(kind).items() if isinstance(value, property)]


def state(part: Any) -> dict[str, Any]:
    """The attributes that differ from those of a new part. An environment without a map has none to set."""
    fresh = type(part)()
    found = {name: getattr(part, name) for name in names(type(part))}
    return {name: value for name, value in found.items() if not _same(value, getattr(fresh, name))}


def restored(kind: type, attributes: dict[str, Any]) -> Any:
    """A part with these attributes."""
    part = kind()
    for name, value in attributes.items():
        setattr(part, name, value)
    if "map" in attributes:  # setting it has changed the kind of the environment
        part.kind = attributes.get("kind", kind().kind)
    return part


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return bool(np.array_equal(a, b))
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(_same(x, y) for x, y in zip(a, b))
    return bool(a == b)


def _equal(a: Any, b: Any) -> Any:
    if type(a) is not type(b):
        return NotImplemented
    return all(_same(getattr(a, name), getattr(b, name)) for name in names(type(a)))


def _describe(part: Any) -> str:
    shown = []
    for name, value in state(part).items():
        is_long = isinstance(value, np.ndarray) and value.size > 16
        shown.append(f"{name}=<array of shape {value.shape}>" if is_long else f"{name}={value!r}")
    return f"relume.{type(part).__name__}({', '.join(shown)})"


def make_values() -> None:
    """Gives the types of parts the methods of values."""
    for kind in TYPES:
        kind.__module__ = "relume"
        setattr(kind, "__eq__", _equal)
        setattr(kind, "__hash__", None)
        setattr(kind, "__repr__", _describe)
        setattr(kind, "__reduce__", lambda part: (restored, (type(part), state(part))))
        setattr(kind, "__copy__", lambda part: part.copy())
        setattr(kind, "__deepcopy__", lambda part, _memo: part.copy())
    for handle in (_core.NodeHandle, _core.MeshHandle, _core.MaterialHandle, _core.LightHandle):
        handle.__module__ = "relume"
