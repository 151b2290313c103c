"""Scripts for a hidden viewer, and their scenes."""

import base64
import json
import os
import pathlib
import re
import struct
import subprocess

from png import png_pixels
from program import PROGRAM, ProgramTest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def combination_table():
    """docs/combinations.md: the cell of each pair of choices ("cache=psf", "guide=cdq"), and the reasons of rejections."""
    table, refused = (ROOT / "docs/combinations.md").read_text().split("\n## Measured")[0].split("\n## Refused")
    rows = [line for line in table.splitlines() if re.match(r"\| \d+ `", line)]
    choices = [re.search("`(.+?)`", row)[1] for row in rows]
    cells = {}
    for i, row in enumerate(rows):
        for k, cell in enumerate(row.split("|")[2:-1]):
            if k > i and cell.strip():
                cells[choices[i], choices[k]] = cell.strip()
    return cells, re.findall(r"^- (.*)$", refused.replace("\n  ", " "), re.MULTILINE)


def steps_to(choice):
    """Settings and values for a choice of that table."""
    slot, value = choice.split("=")
    value, _, method = value.partition(" ")
    return ([("reproject.method", method.strip("()"))] if method else []) + [(slot, value)]


def cube_ply(half):
    """A cube about the origin as a PLY file: an object without camera or light."""
    corners = [(x, y, z) for x in (-half, half) for y in (-half, half) for z in (-half, half)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    lines = ["ply", "format ascii 1.0", f"element vertex {len(corners)}", "property float x", "property float y", "property float z",
             f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(str, corner)) for corner in corners] + ["4 " + " ".join(map(str, face)) for face in faces]
    return "\n".join(lines) + "\n"


def animated_gltf():
    """A triangle with two glTF animations: `turn` of 20 s and `rise` of 3 s."""
    arrays = [("VEC3", [0, 0, 0, 1, 0, 0, 0, 1, 0]), ("SCALAR", [0, 20]), ("VEC4", [0, 0, 0, 1, 0, 1, 0, 0]),
              ("SCALAR", [0, 3]), ("VEC3", [0, 0, 0, 0, 1, 0])]
    sizes = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
    data, views, accessors = b"", [], []
    for kind, values in arrays:
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": 4 * len(values)})
        count = len(values) // sizes[kind]
        accessors.append({"bufferView": len(accessors), "componentType": 5126, "count": count, "type": kind,
                          "min": [min(values[i::sizes[kind]]) for i in range(sizes[kind])],
                          "max": [max(values[i::sizes[kind]]) for i in range(sizes[kind])]})
        data += struct.pack(f"<{len(values)}f", *values)

    def animation(name, path, times):
        return {"name": name, "channels": [{"sampler": 0, "target": {"node": 0, "path": path}}],
                "samplers": [{"input": times, "output": times + 1}]}

    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "sail"}],
        "materials": [{"doubleSided": True}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "animations": [animation("turn", "rotation", 1), animation("rise", "translation", 3)],
        "buffers": [{"uri": uri, "byteLength": len(data)}], "bufferViews": views, "accessors": accessors})


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def length(v):
    return dot(v, v) ** 0.5


class Viewer(ProgramTest):
    THREADS = 1  # of the renderer, which runs while the window is open

    def run_viewer(self, scene, script="", *arguments, frames=2, timeout=280, base=os.environ):
        """Runs the viewer to its end, with the variables of `base`."""
        (self.folder / "steps.txt").write_text(script)
        # A small window, since it is also drawn by the CPU.
        arguments = arguments or ("--width", 240, "--height", 180, "--max-bounces", 2)
        command = [PROGRAM, "view", str(scene), "--smoke", str(frames), "--script", "steps.txt", "--threads", str(self.THREADS), *map(str, arguments)]
        environment = dict(base, XDG_STATE_HOME=str(self.folder / "state"))
        return subprocess.run(command, cwd=self.folder, timeout=timeout, capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False, env=environment)

    def view(self, *arguments, **options):
        """Reports printed by the viewer in order; the last is the final one."""
        done = self.run_viewer(*arguments, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return [json.loads(line) for line in done.stdout.splitlines()]

    def view_while(self, scene, script, actions):
        """Same as view(), with one of the actions after each of the first reports."""
        (self.folder / "steps.txt").write_text(script)
        command = [PROGRAM, "view", str(scene), "--smoke", "1", "--script", "steps.txt", "--threads", "1", "--width", "240", "--height", "180"]
        environment = dict(os.environ, XDG_STATE_HOME=str(self.folder / "state"))
        reports = []
        with subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL, env=environment) as viewer:
            for line in viewer.stdout:
                if len(reports) < len(actions):
                    actions[len(reports)]()
                reports.append(json.loads(line))
            problem = viewer.stderr.read()
        self.assertEqual(viewer.returncode, 0, problem)
        return reports

    def assert_shows_something(self, file):
        width, height, channels, rows = png_pixels(file)
        self.assertGreater(width * height, 100000)
        # The image is in the upper left part of the window.
        values = [row[x * channels + 1] for row in rows[height // 8:height // 2:8] for x in range(width // 8, width // 2, 8)]
        self.assertGreater(sum(values) / len(values), 12, "black")
        self.assertGreater(max(values) - min(values), 20, "all the same")
