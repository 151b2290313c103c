"""Runs the program and reads its outputs. RELUME_PROGRAM is the program's path."""

import base64
import json
import os
import pathlib
import signal
import struct
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["RELUME_PROGRAM"]
SMALL = ["--width", "24", "--height", "18", "--threads", "1"]


def run(*arguments, cwd=None, timeout=120, env=None):
    """Runs the program to its end; its output is text."""
    return subprocess.run([PROGRAM, *map(str, arguments)], cwd=cwd, env=env, timeout=timeout, capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)


def start(*arguments, cwd=None, env=None, ignored=()):
    """Starts the program with these signals ignored. Others have their default action, which a background job of a shell does not inherit."""
    def set_signals():
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN if number in ignored else signal.SIG_DFL)

    return subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=cwd, env=env, preexec_fn=set_signals, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True)


def read_exr_header(data):
    """Attributes of a single-part EXR by name: (type, bytes), and the position behind them (OpenEXR file layout)."""
    assert data[:4] == b"\x76\x2f\x31\x01", "no EXR"
    attributes = {}
    at = 8
    while data[at]:
        end = data.index(0, at)
        name, at = data[at:end].decode(), end + 1
        end = data.index(0, at)
        kind, at = data[at:end].decode(), end + 1
        size = struct.unpack_from("<i", data, at)[0]
        attributes[name] = (kind, data[at + 4:at + 4 + size])
        at += 4 + size
    return attributes, at + 1


def exr_header(file):
    """Attributes of a single-part EXR by name: (type, bytes)."""
    return read_exr_header(pathlib.Path(file).read_bytes())[0]


def exr_pixels(file):
    """The bytes of all pixels as they are stored: everything from the first entry of the offset table on."""
    data = pathlib.Path(file).read_bytes()
    _, table = read_exr_header(data)
    return data[struct.unpack_from("<Q", data, table)[0]:]


def exr_channels(file):
    """Names of the channels in file order."""
    names = []
    data = exr_header(file)["channels"][1]
    while data[0]:
        end = data.index(0)
        names.append(data[:end].decode())
        data = data[end + 17:]
    return names


def exr_strings(file):
    return {name: value.decode() for name, (kind, value) in exr_header(file).items() if kind == "string"}


def png_size(file):
    data = pathlib.Path(file).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG"
    return struct.unpack(">II", data[16:24])


def write_gltf(file, members):
    """Writes a glTF file of a triangle that covers the unit circle and faces +Z, with additional `members`."""
    corners = struct.pack("<9f", -2, -1, 0, 2, -1, 0, 0, 3, 0)
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(members["nodes"])))}],
        "buffers": [{"byteLength": len(corners), "uri": "data:application/octet-stream;base64," + base64.b64encode(corners).decode()}],
        "bufferViews": [{"buffer": 0, "byteLength": len(corners)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        **members,
    }
    pathlib.Path(file).write_text(json.dumps(document))


class ProgramTest(unittest.TestCase):
    """A test with a separate empty folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="relume_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def succeed(self, *arguments, **options):
        done = run(*arguments, cwd=self.folder, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def files(self):
        return sorted(p.name for p in self.folder.iterdir())

    def with_encoder(self, script):
        """Environment with this shell script as `ffmpeg`."""
        folder = self.folder / "bin"
        folder.mkdir()
        (folder / "ffmpeg").write_text("#!/bin/sh\n" + script)
        (folder / "ffmpeg").chmod(0o755)
        return {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}

    def metrics(self, a, b):
        return json.loads(self.succeed("metrics", a, b, "--json").stdout)

    def assert_same_pixels(self, a, b):
        self.assertEqual(self.metrics(a, b)["mse"], 0)
