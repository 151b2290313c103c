"""What the scripts that compare images share: reading an EXR of relume or of Blender."""

import sys

import numpy as np
import OpenImageIO as oiio


def read_image(file):
    """Red, green and blue as a float64 array of height × width × 3; ends the program with a sentence if there are none."""
    buffer = oiio.ImageBuf(str(file))
    if buffer.has_error:
        sys.exit(f"{file}: {buffer.geterror()}")
    # Blender writes "ViewLayer.Combined.R" where we write "R".
    names = [name.split(".")[-1] for name in buffer.spec().channelnames]
    if not set("RGB") <= set(names):
        sys.exit(f"{file}: has no channels R, G and B")
    return np.asarray(buffer.get_pixels(oiio.FLOAT), np.float64)[:, :, [names.index(c) for c in "RGB"]]
