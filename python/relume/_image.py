"""Images: NumPy arrays that show themselves in notebooks."""

import os
from collections.abc import Iterable, Mapping
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._errors import Error

Path = Union[str, "os.PathLike[str]"]


class Image(np.ndarray[Any, np.dtype[np.float32]]):
    """A linear RGB image: a float32 array of shape (height, width, 3); row 0 is on top.

    Notebooks show it with the tone map AgX. Images of a session are read-only, because later frames never change them.
    """

    def _repr_png_(self) -> Union[bytes, None]:
        if self.ndim != 3 or self.shape[2] != 3 or self.size == 0:
            return None
        return to_png(self)

    def __dlpack__(self, **options: Any) -> Any:
        """Exports the memory without a copy. Consumers must not write to the memory of read-only images, of which DLPack
        before version 1 cannot tell."""
        plain = self.view(np.ndarray)
        try:
            return plain.__dlpack__(**options)
        except BufferError:
            return _core.writable_alias(plain).__dlpack__(**options)


def as_image(array: Any) -> Image:
    """`array` as an Image that shares its memory where possible."""
    return np.asarray(array, np.float32).view(Image)


def to_png(image: Any, curve: str = "agx", exposure: float = 0) -> bytes:
    """The bytes of a PNG of `image` after exposure (stops) and the tone map `curve`."""
    return _core.encode_png(_core.tone_map(image, curve, exposure))


def tone_map(image: Any, curve: str = "agx", exposure: float = 0) -> Image:
    """Display-linear values in [0, 1]: multiplies by 2**exposure and applies a tone map.

    `curve` is "none", "reinhard", "aces", "agx" or "neutral".
    """
    return as_image(_core.tone_map(image, curve, exposure))


def read_image(file: Path) -> Image:
    """Reads an EXR, HDR, PNG, JPEG, TGA, BMP, KTX2 or WebP file as linear values. Raises Error if the file is missing or
    malformed."""
    return as_image(_core.read_image(os.fspath(file)))


def write_image(file: Path, image: Any) -> None:
    """Writes an image; the extension selects the format.

    .exr and .hdr store linear values. .png, .jpg and .tga expect display-linear values, as tone_map() returns them.
    Raises Error for other extensions, and if the file cannot be written.
    """
    _core.write_image(os.fspath(file), image)


def read_exr(file: Path) -> dict[str, NDArray[Any]]:
    """The channels of an EXR file by name ("R", "albedo.R", "depth.Z"), each float32 of shape (height, width).
    Raises Error if the file is missing or malformed."""
    return _core.read_exr_channels(os.fspath(file))


def read_exr_attributes(file: Path) -> dict[str, str]:
    """The texts in the header of an EXR file, among them the settings of an image that relume wrote."""
    return _core.read_exr_attributes(os.fspath(file))


def merge(parts: Iterable[Path], output: Path, keep_sums: bool = False) -> int:
    """Merges parts of an image that `relume render --sample-range` wrote, in any order, into the EXR file `output`.

    Returns the number of samples per pixel. `keep_sums` writes a part, which can be merged again. Raises Error for
    parts that do not belong together.
    """
    return _core.merge([os.fspath(part) for part in parts], os.fspath(output), keep_sums)


def write_exr(file: Path, channels: Any, attributes: Union[Mapping[str, str], None] = None) -> None:
    """Writes an EXR file of 32-bit floats.

    `channels` is an image of shape (height, width, 3), or a dict of arrays of shape (height, width) by channel name.
    `attributes` are stored as text in the header.
    """
    if not isinstance(channels, Mapping):
        image = np.asarray(channels, np.float32)
        if image.ndim != 3 or image.shape[2] != 3:
            raise Error(f"an image has the shape (height, width, 3), not {image.shape}; give such an array, or a dict")
        channels = {name: image[:, :, i] for i, name in enumerate("RGB")}
    _core.write_exr_channels(os.fspath(file), dict(channels), dict(attributes or {}))

