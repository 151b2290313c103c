"""Images of the scenes: a letter, a mask, and one sky as a map of equal areas (pbrt) and an equirectangular one."""

import math
import struct
import zlib

LETTER = ("................", ".#########......", ".###########....", ".###......###...", ".###.......##...", ".###......###...",
          ".###########....", ".#########......", ".###...###......", ".###....###.....", ".###.....###....", ".###......###...",
          ".###.......###..", ".###........##..", "................", "................")  # fmt: skip
SIZE = len(LETTER)
EQUAL_AREA_SIDE = 128
ROWS = 64  # of the equirectangular map
HALF = 1   # type of a channel in EXR


def png(rows, channels):
    """PNG with 8 bits per channel; each row is a list of tuples (PNG specification, ISO/IEC 15948)."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    color_type = {1: 0, 3: 2, 4: 6}[channels]
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, color_type, 0, 0, 0)
    data = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(data, 0)) + chunk(b"IEND", b"")


def exr(rows):
    """Uncompressed EXR of RGB tuples in half precision (OpenEXR file layout)."""

    def attribute(name, kind, data):
        return f"{name}\0{kind}\0".encode() + struct.pack("<i", len(data)) + data

    width, height = len(rows[0]), len(rows)
    channels = b"".join(name + b"\0" + struct.pack("<iBxxxii", HALF, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = b"\x76\x2f\x31\x01" + struct.pack("<i", 2) + attribute("channels", "chlist", channels)
    header += attribute("compression", "compression", b"\0")
    header += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
    header += attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    line_bytes = 8 + 6 * width
    first = len(header) + 8 * height
    table = struct.pack(f"<{height}Q", *(first + y * line_bytes for y in range(height)))
    lines = b"".join(struct.pack(f"<ii{3 * width}e", y, 6 * width, *(pixel[c] for c in (2, 1, 0) for pixel in row)) for y, row in enumerate(rows))
    return header + table + lines


def letter_color(x, y):
    """An R on a background that grows red to the right and green downwards; sRGB-encoded."""
    if LETTER[y][x] == "#":
        return (20, 40, 160)
    return (90 + 10 * x, 90 + 10 * y, 70)


def mask_value(x, y):
    """Opacity: 0 in the letter and 255 elsewhere."""
    return 0 if LETTER[y][x] == "#" else 255


def lobe(d, axis, sharpness):
    length = math.sqrt(sum(a * a for a in axis))
    return math.exp(sharpness * (sum(a * b for a, b in zip(d, axis)) / length - 1))


def sky(d):
    """Radiance from direction `d`, +Y up: a red, a green and a blue lobe."""
    return (0.1 + lobe(d, (1, 1, 1), 1.5), 0.1 + 0.8 * lobe(d, (-1, 0.5, 0.7), 1.5), 0.2 + 0.1 * d[1] + 0.9 * lobe(d, (-0.2, 0.3, -1), 1.5))


def equirectangular_sky():
    """Row 0 is +Y, the centre column looks along -Z with +X to its right."""

    def direction(x, y):
        theta, phi = math.pi * (y + 0.5) / ROWS, math.pi * ((x + 0.5) / ROWS - 1)
        return math.sin(theta) * math.sin(phi), math.cos(theta), -math.sin(theta) * math.cos(phi)

    return [[sky(direction(x, y)) for x in range(2 * ROWS)] for y in range(ROWS)]


def equal_area_direction(u, v):
    """Direction of a point of the unit square, +Z up (Clarberg 2008, as in pbrt-v4)."""
    u, v = 2 * u - 1, 2 * v - 1
    to_diagonal = 1 - abs(u) - abs(v)
    r = 1 - abs(to_diagonal)
    phi = math.pi / 4 * ((abs(v) - abs(u)) / r + 1 if r else 1)
    sine = r * math.sqrt(2 - r * r)
    return math.copysign(math.cos(phi), u) * sine, math.copysign(math.sin(phi), v) * sine, math.copysign(1 - r * r, to_diagonal)


def equal_area_sky():
    """The sky turned from +Y up to +Z up: pbrt's `Rotate -90 1 0 0` turns it back."""

    def value(x, y):
        d = equal_area_direction((x + 0.5) / EQUAL_AREA_SIDE, (y + 0.5) / EQUAL_AREA_SIDE)
        return sky((d[0], d[2], -d[1]))

    return [[value(x, y) for x in range(EQUAL_AREA_SIDE)] for y in range(EQUAL_AREA_SIDE)]


def image_files():
    """(name, content) of every image."""
    square = [[(x, y) for x in range(SIZE)] for y in range(SIZE)]
    yield "letter.png", png([[letter_color(*p) for p in row] for row in square], 3)
    yield "mask.png", png([[(mask_value(*p),) for p in row] for row in square], 1)
    yield "masked.png", png([[(255, 255, 255, mask_value(*p)) for p in row] for row in square], 4)
    yield "sky.exr", exr(equirectangular_sky())
    yield "sky_equal_area.exr", exr(equal_area_sky())
