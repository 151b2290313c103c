"""Seeded damage to a file's bytes. Each function takes bytes and a random.Random, and returns bytes."""

import json
import re
import struct

# As text, for text files and the command line.
EXTREME_NUMBERS = ["0", "-0", "-1", "1", "255", "256", "65536", "2147483647", "2147483648", "-2147483649", "4294967295", "4294967296",
                   "9223372036854775807", "9223372036854775808", "18446744073709551616", "1e308", "-1e308", "1e39", "1e-320", "1e999",
                   "NaN", "nan", "inf", "-inf", "Infinity", "0x10", "1.5", "1,5", "--1", "1e", "", "99999999999999999999999999999999"]

ODD_STRINGS = [b"", b" ", b"\0", b"a" * 300, b"x" * 70000, b"\xff\xfe\x80", "é☃𐍈".encode(), b"../../outside.png", b"/", b".", b"/dev/null", b"%s%n%x",
               b"{}{0}", b"a\nb", b"a\r\nb", b"\x1b[31m", b"\\", b"'\"", b"#", b"http://example.org/a.png", b"file:///nowhere/a.png", b"data:,", b"data:image/png;base64,!!!!",
               b"*0", b"\xed\xa0\x80", b"\xc0\xaf", b"\xef\xbb\xbf"]

NUMBER = re.compile(rb"-?\d+(?:\.\d*)?(?:[eE][+-]?\d+)?")
STRING = re.compile(rb'"[^"\n]*"|(?<=[ =>])[A-Za-z_][\w.#:-]*')


def flip_bits(data, rng):
    out = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 8, 64))):
        out[rng.randrange(len(out))] ^= 1 << rng.randrange(8)
    return bytes(out)


def random_bytes(data, rng):
    out = bytearray(data)
    for _ in range(rng.choice((1, 2, 4, 16))):
        at = rng.randrange(len(out))
        out[at:at + rng.choice((1, 2, 4, 8))] = rng.randbytes(rng.choice((1, 2, 4, 8)))
    return bytes(out)


def truncate(data, rng):
    return data[: rng.choice((0, 1, 4, len(data) - 1, rng.randrange(len(data)), rng.randrange(len(data))))]


def duplicate_chunk(data, rng):
    at, size = rng.randrange(len(data)), rng.choice((1, 4, 16, 64, 256, len(data)))
    return data[: at + size] + data[at:at + size] * rng.choice((1, 1, 2, 100)) + data[at + size:]


def delete_chunk(data, rng):
    at = rng.randrange(len(data))
    return data[:at] + data[at + rng.choice((1, 4, 16, 64, 256)):]


def swap_chunks(data, rng):
    a, b = sorted((rng.randrange(len(data)), rng.randrange(len(data))))
    size = rng.choice((1, 4, 16, 64))
    return data[:a] + data[b:b + size] + data[a + size:b] + data[a:a + size] + data[b + size:]


def lie_about_sizes(data, rng):
    """Replaces numbers of 1, 2, 4 or 8 bytes, usually near the start, by extremes."""
    out = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 4))):
        code = rng.choice("BHIIIQfd") if rng.random() < 0.7 else rng.choice("IH")
        order = rng.choice("<<<>")
        if code in "fd":
            value = rng.choice((0.0, -1.0, 1e30, float("nan"), float("inf"), -float("inf"), 1e-40))
        else:
            top = (1 << 8 * struct.calcsize(code)) - 1
            value = rng.choice((0, 1, top, top >> 1, (top >> 1) + 1, top - 7, top >> 8, len(data), 2 * len(data), top >> 2)) & top
        reach = len(out) if rng.random() < 0.4 else min(len(out), 128)
        at = rng.randrange(reach)
        packed = struct.pack(order + code, value)
        out[at:at + len(packed)] = packed
    return bytes(out)


def extreme_numbers(data, rng):
    """Replaces numbers in text."""
    places = list(NUMBER.finditer(data))
    for match in sorted(rng.sample(places, min(len(places), rng.choice((1, 1, 2, 5)))), key=lambda m: -m.start()):
        data = data[: match.start()] + rng.choice(EXTREME_NUMBERS).encode() + data[match.end():]
    return data


def odd_strings(data, rng):
    """Replaces quoted strings, words and names in text."""
    places = list(STRING.finditer(data))
    for match in sorted(rng.sample(places, min(len(places), rng.choice((1, 1, 3)))), key=lambda m: -m.start()):
        quote = b'"' if match[0].startswith(b'"') else b""
        data = data[: match.start()] + quote + rng.choice(ODD_STRINGS) + quote + data[match.end():]
    return data


def shuffle_lines(data, rng):
    lines = data.splitlines(keepends=True)
    at, count = rng.randrange(len(lines)), rng.choice((1, 1, 2, 5))
    taken = lines[at:at + count]
    what = rng.randrange(4)
    if what == 0:
        del lines[at:at + count]
    elif what == 1:
        lines[at:at] = taken * rng.choice((1, 2, 1000))
    elif what == 2:
        lines.insert(rng.randrange(len(lines)), lines.pop(at))
    else:
        lines[at] = rng.choice(ODD_STRINGS) + b" " + lines[at]
    return b"".join(lines)


def nest_deeply(data, rng):
    """Inserts a long run of an opening bracket or tag."""
    depth = rng.choice((100, 2000, 100000))
    opener = rng.choice((b"[", b'{"a":', b"(", b"<a>", b"{", b"a: {\n", b"\n", b" "))
    at = rng.randrange(len(data))
    return data[:at] + opener * depth + data[at:]


def json_places(value, path=()):
    """Paths of every value inside `value`."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    found = []
    for key, inner in items:
        found.append(path + (key,))
        found += json_places(inner, path + (key,))
    return found


def other_json(old, rng):
    """Replacement of `old`: another type, an extreme number, or an index that may form a cycle."""
    if isinstance(old, int) and not isinstance(old, bool) and rng.random() < 0.6:
        return rng.choice((0, 1, 2, 3, old + 1, old - 1, -1, 1 << 31, 1 << 53, 1 << 63, (1 << 64) - 1, 10**9, old * 1000, 1e308, 0.5))
    if isinstance(old, float) and rng.random() < 0.6:
        return rng.choice((0.0, -1.0, 1e308, -1e308, 1e39, 1e-45, float("nan"), float("inf"), 1e9))
    if isinstance(old, list) and rng.random() < 0.5:
        return rng.choice(([], old + old, old[:-1], [old], old * (1000 if len(old) < 20 else 2), [0, 1, 2, 3, 4, 5], [None] * len(old)))
    deep = []
    for _ in range(rng.choice((3, 200))):
        deep = [deep]
    return rng.choice((None, True, 0, -1, 1.5, "", "a" * 1000, "\0", "\x1b[2J", "a\nb", [], {}, [[]], {"a": {}}, deep, {"": 0}, [1e308] * 3, "0"))


def change_json(data, rng):
    """Changes types, numbers, keys and references of a JSON document; other bytes get other damage."""
    try:
        document = json.loads(data)
    except (ValueError, RecursionError):  # already damaged
        return extreme_numbers(data, rng)
    for _ in range(rng.choice((1, 1, 2, 4))):
        places = json_places(document)
        if not places:
            break
        path = rng.choice(places)
        owner = document
        for key in path[:-1]:
            owner = owner[key]
        key = path[-1]
        what = rng.random()
        if what < 0.7:
            owner[key] = other_json(owner[key], rng)
        elif what < 0.85:
            del owner[key]
        elif isinstance(owner, dict):
            owner[rng.choice(("", "a" * 500, "extras", "\n", "extensions", "children", "\x7f"))] = owner[key]
        else:
            owner.insert(rng.randrange(len(owner) + 1), owner[key])
    return json.dumps(document).encode()


def change_glb_json(data, rng):
    """Changes the JSON inside a GLB, with matching lengths."""
    if len(data) < 20:
        return random_bytes(data, rng)
    size = struct.unpack_from("<I", data, 12)[0]
    text = change_json(data[20:20 + size], rng)
    text += b" " * (-len(text) % 4)
    rest = data[20 + size:]
    return data[:8] + struct.pack("<II", 20 + len(text) + len(rest), len(text)) + data[16:20] + text + rest


ON_BYTES = [flip_bits, random_bytes, truncate, duplicate_chunk, delete_chunk, swap_chunks, lie_about_sizes, lie_about_sizes]
ON_TEXT = [extreme_numbers, extreme_numbers, extreme_numbers, odd_strings, odd_strings, shuffle_lines, nest_deeply]
ON_JSON = [change_json] * 8 + [extreme_numbers, odd_strings, nest_deeply]


def damage(name, data, rng):
    """Damages `data` according to the type of file `name`."""
    if not data:
        return data
    choices = list(ON_BYTES)
    if name.endswith((".gltf", ".json")):
        choices = ON_JSON if rng.random() < 0.8 else ON_BYTES
    elif data[:4] == b"glTF":
        choices = [change_glb_json] * 8 + ON_BYTES
    elif b"\0" not in data[:200] and rng.random() < 0.75:
        choices = ON_TEXT
    return rng.choice(choices)(data, rng)
