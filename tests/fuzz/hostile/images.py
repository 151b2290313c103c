"""Encoders of small gradient images: PNG, JPEG, BMP, TGA, HDR and EXR."""

import struct
import zlib


def gradient(width, height, channels):
    """Rows of a gradient, as bytes."""
    return [bytes((31 * x + 57 * y + 83 * c) % 256 for x in range(width) for c in range(channels)) for y in range(height)]


def png(width=8, height=6, depth=8, channels=4):
    """ISO/IEC 15948, unfiltered."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    colour_type = {1: 0, 2: 4, 3: 2, 4: 6}[channels]
    rows = gradient(width, height, channels * depth // 8)
    header = struct.pack(">IIBBBBB", width, height, depth, colour_type, 0, 0, 0)
    pixels = zlib.compress(b"".join(b"\0" + row for row in rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")


def palette_png():
    """Two bits per pixel and four colours, one of them transparent."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", 8, 2, 2, 3, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"PLTE", bytes(range(12))) + chunk(b"tRNS", b"\0\xff")
            + chunk(b"IDAT", zlib.compress(b"\0\x1b\x1b\0\xe4\xe4")) + chunk(b"IEND", b""))


def jpeg(components=3):
    """ITU-T T.81 baseline, 16 × 16 grey pixels: every coefficient is zero, so that each Huffman table has one code."""
    def segment(marker, data):
        return b"\xff" + bytes([marker]) + struct.pack(">H", len(data) + 2) + data

    frame = struct.pack(">BHHB", 8, 16, 16, components) + b"".join(bytes([c + 1, 0x11, 0]) for c in range(components))
    one_code = bytes([1] + [0] * 15 + [0])
    scan = bytes([components]) + b"".join(bytes([c + 1, 0]) for c in range(components)) + bytes([0, 63, 0])
    bits = "00" * components * 4  # four units, each with a DC difference of zero and an end of block
    bits += "1" * (-len(bits) % 8)
    data = bytes(int(bits[i:i + 8], 2) for i in range(0, len(bits), 8))
    return (b"\xff\xd8" + segment(0xdb, b"\0" + bytes([1] * 64)) + segment(0xc0, frame) + segment(0xc4, b"\0" + one_code)
            + segment(0xc4, b"\x10" + one_code) + segment(0xda, scan) + data + b"\xff\xd9")


def bmp(width=8, height=6):
    rows = [row + bytes(-len(row) % 4) for row in gradient(width, height, 3)]
    pixels = b"".join(rows)
    head = b"BM" + struct.pack("<IHHI", 54 + len(pixels), 0, 0, 54)
    return head + struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, len(pixels), 2835, 2835, 0, 0) + pixels


def tga(width=8, height=6, packed=False):
    head = struct.pack("<BBBHHBHHHHBB", 0, 0, 10 if packed else 2, 0, 0, 0, 0, 0, width, height, 24, 0x20)
    rows = gradient(width, height, 3)
    return head + b"".join((bytes([width - 1]) if packed else b"") + row for row in rows)


def hdr(width=16, height=8, packed=True):
    """Radiance RGBE, with the newer run-length encoding."""
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1.0\n\n-Y {height} +X {width}\n".encode()
    rows = [bytes(128 if i % 4 == 3 else value for i, value in enumerate(row)) for row in gradient(width, height, 4)]
    if not packed:
        return head + b"".join(rows)
    body = b""
    for row in rows:
        body += struct.pack(">BBH", 2, 2, width)
        for c in range(4):
            body += bytes([128 + width // 2, row[c]]) + bytes([width - width // 2]) + row[c::4][: width - width // 2]
    return head + body


def _attribute(name, kind, data):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data


def _packed(data):
    """EXR's ZIP: even bytes before odd ones, differences, deflate; uncompressed if that is not longer."""
    split = data[0::2] + data[1::2]
    differences = split[:1] + bytes((b - a + 128) % 256 for a, b in zip(split, split[1:]))
    packed = zlib.compress(differences)
    return packed if len(packed) < len(data) else data


def exr(width=8, height=6, half=False, compress=True, tiled=False, texts=None, channels=("B", "G", "R")):
    """OpenEXR file layout, one part; `texts` become string attributes."""
    kind, pixel = (1, "<e") if half else (2, "<f")
    listing = b"".join(c.encode() + b"\0" + struct.pack("<iB3xii", kind, 0, 1, 1) for c in channels) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = b"\x76\x2f\x31\x01" + struct.pack("<I", 2 | (0x200 if tiled else 0)) + _attribute("channels", "chlist", listing)
    header += _attribute("compression", "compression", b"\3" if compress else b"\0") + _attribute("lineOrder", "lineOrder", b"\0")
    header += _attribute("dataWindow", "box2i", window) + _attribute("displayWindow", "box2i", window)
    header += _attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += _attribute("screenWindowCenter", "v2f", bytes(8)) + _attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    header += _attribute("tiles", "tiledesc", struct.pack("<IIB", width, height, 0)) if tiled else b""
    header += b"".join(_attribute(name, "string", text.encode()) for name, text in (texts or {}).items()) + b"\0"

    def row(y):
        return b"".join(struct.pack(pixel, 0.1 * x + 0.05 * y + 0.2) for _ in channels for x in range(width))

    lines = height if tiled else 16 if compress else 1
    chunks = []
    for first in range(0, height, lines):
        data = b"".join(row(y) for y in range(first, min(first + lines, height)))
        data = _packed(data) if compress else data
        place = struct.pack("<4i", 0, 0, 0, 0) if tiled else struct.pack("<i", first)
        chunks.append(place + struct.pack("<i", len(data)) + data)
    offsets, at = b"", len(header) + 8 * len(chunks)
    for chunk in chunks:
        offsets += struct.pack("<Q", at)
        at += len(chunk)
    return header + offsets + b"".join(chunks)
