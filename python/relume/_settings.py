"""Settings by name, as keyword arguments."""

import json
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, Union

from . import _core
from ._errors import Error
from ._names import nearest

Value = Union[str, int, float, bool]


class SettingInfo(NamedTuple):
    """A declared setting."""

    name: str
    """In the form of the command line: "psf.cell-size"."""
    type: str
    default: str
    help: str

    @property
    def keyword(self) -> str:
        """As keyword argument: "psf_cell_size"."""
        return keyword_of(self.name)


def keyword_of(name: str) -> str:
    return name.replace(".", "_").replace("-", "_")


_NAMES = {keyword_of(entry[0]): entry[0] for entry in _core.list_settings()}


def settings() -> list[SettingInfo]:
    """All settings, in the order of docs/settings.md."""
    return [SettingInfo(*entry) for entry in _core.list_settings()]


def presets() -> list[str]:
    """Names of the presets."""
    return list(_core.list_presets())


def full_name(name: str) -> str:
    """Name of a setting on the command line. `name` may be that name or the keyword argument."""
    keyword = keyword_of(name)
    if keyword not in _NAMES:
        near = nearest(keyword, _NAMES)
        remedy = f"did you mean '{near}'?" if near else "relume.settings() lists all"
        raise Error(f"there is no setting '{name}'; {remedy}", "not-found")
    return _NAMES[keyword]


def texts(values: Mapping[str, Value]) -> list[tuple[str, str]]:
    """Full names and texts of settings, in the form of the command line. Checks both."""
    checked = Settings(settings=values)
    return [(full_name(name), checked[name]) for name in values]


class Settings(Mapping[str, str]):
    """A value for every setting: defaults, then a preset, then keyword arguments.

    Reading gives the text of a value in the form of the command line:

    >>> Settings(preset="interactive", psf_cell_size=4)["psf_cell_size"]
    '4'
    """

    def __init__(self, preset: Union[str, None] = None, *, settings: Union[Mapping[str, Value], None] = None,
                 **values: Value) -> None:
        self._core = _core.SettingsCore()
        if preset is not None:
            self.apply_preset(preset)
        for name, value in {**(settings or {}), **values}.items():
            self[name] = value

    def __setitem__(self, name: str, value: Value) -> None:
        if hasattr(value, "item"):  # a NumPy scalar
            value = value.item()
        if not isinstance(value, (str, int, float)):
            raise Error(f"{name} cannot be {value!r}; give a text, a number or a bool")
        self._core.set(full_name(name), value)

    def __getitem__(self, name: str) -> str:
        return self._core.get(full_name(name))

    def __iter__(self) -> Iterator[str]:
        return iter(_NAMES)

    def __len__(self) -> int:
        return len(_NAMES)

    def copy(self) -> "Settings":
        """Independent settings with the same values."""
        copied = Settings()
        copied._core = _core.SettingsCore(self._core)
        return copied

    def apply_preset(self, name: str) -> None:
        """Applies the values of a preset; others stay."""
        self._core.apply_preset(name)

    def apply_json(self, text: str, place: str = "settings") -> None:
        """Applies a JSON object of names and values; errors name `place`."""
        self._core.apply_json(text, place)

    def to_dict(self) -> dict[str, Any]:
        """All values, by full name."""
        return json.loads(self._core.to_json())  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        defaults = Settings()
        changed = [f"{name}={self[name]!r}" for name in self if self[name] != defaults[name]]
        return f"<relume.Settings {', '.join(changed) or 'with all defaults'}>"
