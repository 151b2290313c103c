"""Reads the EXR files that relume and pbrt write: scanlines of half or float channels, uncompressed or ZIP."""

import pathlib
import struct
import sys
import zlib

LINES_PER_CHUNK = {0: 1, 2: 1, 3: 16}  # by compression: none, ZIPS, ZIP
FORMATS = {1: "e", 2: "f"}             # of struct, by type of channel: half, float


def text_at(data, at):
    end = data.index(0, at)
    return data[at:end].decode(), end + 1


def header_of(data):
    """Attributes by name, and the offset after them (OpenEXR file layout)."""
    attributes, at = {}, 8
    while data[at]:
        name, at = text_at(data, at)
        _, at = text_at(data, at)
        size = struct.unpack_from("<i", data, at)[0]
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def channels_of(data):
    """(name, format) of each channel in file order."""
    channels, at = [], 0
    while data[at]:
        name, at = text_at(data, at)
        channels.append((name, FORMATS[struct.unpack_from("<i", data, at)[0]]))
        at += 16
    return channels


def unzipped(packed, size):
    """Reverses the ZIP compression of EXR: differences of bytes, the even ones first."""
    if len(packed) == size:
        return packed
    raw = bytearray(zlib.decompress(packed))
    for i in range(1, size):
        raw[i] = (raw[i - 1] + raw[i] - 128) & 255
    result = bytearray(size)
    result[0::2], result[1::2] = raw[:(size + 1) // 2], raw[(size + 1) // 2:]
    return bytes(result)


def read_exr(file):
    """Rows of (R, G, B). Exits with a message if the file is of another kind."""
    data = pathlib.Path(file).read_bytes()
    try:
        attributes, at = header_of(data)
        left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
        width, height = right - left + 1, bottom - top + 1
        channels = channels_of(attributes["channels"])
        compression = attributes["compression"][0]
        lines = LINES_PER_CHUNK[compression]
        line_bytes = width * sum(struct.calcsize(kind) for _, kind in channels)
        rows = [None] * height
        for offset in struct.unpack_from(f"<{-(-height // lines)}Q", data, at):
            y, size = struct.unpack_from("<2i", data, offset)
            first = y - top
            count = min(lines, height - first)
            chunk = data[offset + 8:offset + 8 + size]
            pixels = unzipped(chunk, count * line_bytes) if compression else chunk
            for i in range(count):
                planes, start = {}, i * line_bytes
                for name, kind in channels:
                    planes[name] = struct.unpack_from(f"<{width}{kind}", pixels, start)
                    start += width * struct.calcsize(kind)
                rows[first + i] = list(zip(planes["R"], planes["G"], planes["B"]))
        return rows
    except (KeyError, ValueError, IndexError, struct.error, zlib.error) as error:
        sys.exit(f"{file}: not an EXR with channels R, G and B, uncompressed or with ZIP ({error!r})")
