"""Reads EXR files of relume and Blender for the scripts that compare images."""

import sys

import numpy as np
import OpenImageIO as oiio


def read_image(file):
    """Channels R, G and B as a float64 array of height × width × 3. Exits with a message if the file cannot be read or
    lacks one of them."""
    buffer = oiio.ImageBuf(str(file))
    if buffer.has_error:
        sys.exit(f"{file}: {buffer.geterror()}")
    # Blender writes "ViewLayer.Combined.R" instead of "R".
    names = [name.split(".")[-1] for name in buffer.spec().channelnames]
    if not set("RGB") <= set(names):
        sys.exit(f"{file}: the file has the channels {', '.join(names)}, but needs R, G and B")
    return np.asarray(buffer.get_pixels(oiio.FLOAT), np.float64)[:, :, [names.index(c) for c in "RGB"]]
