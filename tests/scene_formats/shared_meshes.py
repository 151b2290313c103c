"""Shapes of the scenes, as PLY and as buffers for glTF. Texture coordinates have v upwards, as in pbrt."""

import dataclasses
import math
import struct

SEGMENTS = 96  # per turn, as relume tessellates the quadrics of pbrt and Mitsuba


@dataclasses.dataclass
class Shape:
    positions: list
    faces: list
    normals: list = dataclasses.field(default_factory=list)
    uv: list = dataclasses.field(default_factory=list)


def triangles_of(shape):
    """Polygons as fans."""
    return [(face[0], face[i], face[i + 1]) for face in shape.faces for i in range(1, len(face) - 1)]


def quad():
    """The square [-1, 1]² in the plane z = 0, facing +Z."""
    return Shape([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)], uv=[(0, 0), (1, 0), (1, 1), (0, 1)])


def add_box(shape, low, high, back):
    """Adds a box with separate vertices for each face; its back face is scaled by `back` about the axis Z."""

    def corner(x, y, z):
        scale = 1 if z else back
        return (scale * (high[0] if x else low[0]), scale * (high[1] if y else low[1]), high[2] if z else low[2])

    faces = (((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)), ((1, 0, 0), (0, 0, 0), (0, 1, 0), (1, 1, 0)),
             ((1, 0, 1), (1, 0, 0), (1, 1, 0), (1, 1, 1)), ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)),
             ((0, 1, 1), (1, 1, 1), (1, 1, 0), (0, 1, 0)), ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)))  # fmt: skip
    for face in faces:
        first = len(shape.positions)
        shape.positions += [corner(*c) for c in face]
        shape.faces.append(tuple(range(first, first + 4)))


def cube():
    """The cube [-1, 1]³."""
    shape = Shape([], [])
    add_box(shape, (-1, -1, -1), (1, 1, 1), 1)
    return shape


def letter():
    """An F that faces +Z and is smaller at its back, so that each mirror image differs."""
    shape = Shape([], [])
    for low, high in (((-0.5, -0.8), (-0.2, 0.8)), ((-0.2, 0.5), (0.5, 0.8)), ((-0.2, -0.1), (0.25, 0.2))):
        add_box(shape, (*low, -0.2), (*high, 0.2), 0.7)
    return shape


def grid(columns, rows, vertex):
    """Shape of the points and normals vertex(u, v)."""
    shape = Shape([], [])
    for j in range(rows + 1):
        for i in range(columns + 1):
            position, normal = vertex(i % columns / columns, j / rows)
            shape.positions.append(position)
            shape.normals.append(normal)
    for a in (j * (columns + 1) + i for j in range(rows) for i in range(columns)):
        for face in ((a, a + 1, a + columns + 2), (a, a + columns + 2, a + columns + 1)):
            if len({shape.positions[i] for i in face}) == 3:
                shape.faces.append(face)
    return shape


def around(u):
    return math.cos(2 * math.pi * u), math.sin(2 * math.pi * u)


def sphere():
    """The unit sphere, from its pole at -Z."""

    def vertex(u, v):
        sine = 0 if v in (0, 1) else math.sin(math.pi * v)
        point = (around(u)[0] * sine, around(u)[1] * sine, -math.cos(math.pi * v))
        return point, point

    return grid(SEGMENTS, SEGMENTS // 2, vertex)


def disk():
    """The unit disk in the plane z = 0, facing +Z."""
    return grid(SEGMENTS, 1, lambda u, v: ((around(u)[0] * (1 - v), around(u)[1] * (1 - v), 0), (0, 0, 1)))


def cylinder():
    """The open cylinder of radius 1 about Z from z = 0 to z = 1, facing outwards."""
    return grid(SEGMENTS, 1, lambda u, v: ((*around(u), v), (*around(u), 0)))


SHAPES = {"quad": quad(), "cube": cube(), "letter": letter(), "sphere": sphere(), "disk": disk(), "cylinder": cylinder()}


def buffer_of(shape):
    """Positions, normals, texture coordinates with v downwards, and indices."""
    floats = [x for values in (shape.positions, shape.normals) for p in values for x in p]
    floats += [x for u, v in shape.uv for x in (u, 1 - v)]
    indices = [i for triangle in triangles_of(shape) for i in triangle]
    return struct.pack(f"<{len(floats)}f{len(indices)}H", *floats, *indices)


def ply_of(shape):
    """Triangles, because Mitsuba reads no other polygons: ASCII, or binary PLY of a shape with normals."""
    names = ["x", "y", "z", *(["nx", "ny", "nz"] if shape.normals else []), *(["u", "v"] if shape.uv else [])]
    triangles = triangles_of(shape)
    encoding = "binary_little_endian" if shape.normals else "ascii"
    lines = ["ply", f"format {encoding} 1.0", f"element vertex {len(shape.positions)}"]
    lines += [f"property float {name}" for name in names]
    lines += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    header = ("\n".join(lines) + "\n").encode()
    nothing = [()] * len(shape.positions)
    rows = [(*p, *n, *uv) for p, n, uv in zip(shape.positions, shape.normals or nothing, shape.uv or nothing)]
    if shape.normals:
        vertices = b"".join(struct.pack(f"<{len(names)}f", *row) for row in rows)
        return header + vertices + b"".join(struct.pack("<B3i", 3, *triangle) for triangle in triangles)
    text = [" ".join(f"{x:g}" for x in row) for row in rows] + ["3 " + " ".join(map(str, t)) for t in triangles]
    return header + ("\n".join(text) + "\n").encode()
