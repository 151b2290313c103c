"""A light tree: at each node, a random number selects a child in proportion to the bound of its light at x."""

import math

from draw import Drawing

X = (90, 250)
NODE = 15


def between(d, start, end, draw, **style):
    """A line or an arrow from the border of one node to that of another."""
    angle = math.atan2(end[1] - start[1], end[0] - start[0])
    shift = (NODE * math.cos(angle), NODE * math.sin(angle))
    draw((start[0] + shift[0], start[1] + shift[1]), (end[0] - shift[0], end[1] - shift[1]), **style)


def tangents(d, center, radius, **style):
    """The cone under which X sees a sphere."""
    dx, dy = center[0] - X[0], center[1] - X[1]
    distance = math.hypot(dx, dy)
    reach = math.sqrt(distance**2 - radius**2)
    for turn in (-1, 1):
        angle = math.atan2(dy, dx) + turn * math.asin(radius / distance)
        d.line(X, (X[0] + reach * math.cos(angle), X[1] + reach * math.sin(angle)), **style)


def scene(d):
    d.line((10, X[1]), (300, X[1]), width=2)
    d.circle(80, 94, 66, role="orange", fill=("orange", 0.08))
    d.circle(52, 100, 28, role="orange", fill=("orange", 0.2))
    d.circle(110, 80, 28, role="faint", fill=("faint", 0.12))
    d.circle(234, 74, 46, role="faint", fill=("faint", 0.08))
    for x, y in ((42, 92), (62, 108), (100, 80), (120, 80), (216, 62), (252, 66), (234, 96)):
        d.dot(x, y)
    d.text(80, 18, "A", role="orange", anchor="middle")
    d.text(234, 18, "B", role="faint", anchor="middle")
    tangents(d, (80, 94), 66, role="blue", dashed=True)
    d.arrow(X, (63, 115), role="green", width=2.5)
    d.dot(*X)
    d.text(X[0], 276, "x", anchor="middle")
    d.text(146, 192, "bound of A at x:", role="blue")
    d.text(146, 216, "I · cos θ′ · cos θᵢ′ / d²", role="blue")


def tree(d):
    root, a, b = (486, 44), (424, 128), (564, 128)
    leaf, other = (380, 210), (468, 210)
    between(d, root, a, d.arrow, role="green", width=2.5)
    between(d, a, leaf, d.arrow, role="green", width=2.5)
    between(d, root, b, d.line, role="faint")
    between(d, a, other, d.line, role="faint")
    for at, role in ((root, "ink"), (a, "orange"), (b, "faint"), (leaf, "orange"), (other, "faint")):
        d.circle(*at, NODE, role=role, fill=(role, 0.14))
    d.text(a[0], a[1] + 6, "A", role="orange", anchor="middle")
    d.text(b[0], b[1] + 6, "B", role="faint", anchor="middle")
    d.text(440, 82, "0.8", role="green", anchor="end")
    d.text(536, 82, "0.2", role="faint")
    d.text(390, 168, "0.7", role="green", anchor="end")
    d.text(458, 168, "0.3", role="faint")
    for side, role in ((-16, "faint"), (16, "green")):
        d.line((leaf[0] + side / 4, leaf[1] + NODE), (leaf[0] + side, 250), role=role, width=2.5 if side > 0 else 1.5)
        d.dot(leaf[0] + side, 254)
    d.text(402, 246, "0.5", role="green")
    d.text(366, 288, "p(light) = 0.8 · 0.7 · 0.5", role="green")


def draw():
    d = Drawing(620, 300, "A light tree is descended at random: the importance of each child at x decides the step")
    scene(d)
    tree(d)
    return d
