"""All directions at one point, unfolded to a square: the density of the tree on the left, that of the light on the right."""

import math

from draw import Drawing

SIZE = 150
TOP = 56
TREE_X, LIGHT_X = 270, 456
POINT = (112, 150)
LAMP = (0.66, 0.3)


def square(d, x, role, label):
    d.rectangle(x, TOP, SIZE, SIZE, role=role, stroke=2)
    d.text(x + SIZE / 2, TOP - 14, label, role=role, anchor="middle")


def draw():
    d = Drawing(630, 280, "View of directions: the density of the tree and that of the incident light at one point, side by side")
    x, y = POINT
    d.line((24, y), (200, y), width=2)
    for i in range(11):
        angle = math.pi * (i + 0.5) / 11
        towards_lamp = i == 3
        end = (x + 68 * math.cos(angle), y - 68 * math.sin(angle))
        d.arrow((x, y), end, role="blue" if towards_lamp else "faint", width=2 if towards_lamp else 1.2)
    d.circle(x + 92 * math.cos(math.pi * 3.5 / 11), y - 92 * math.sin(math.pi * 3.5 / 11), 11, fill=("ink", 0.15))
    d.dot(x, y)
    d.text(x, y + 24, "first hit of a pixel", anchor="middle")

    left = TREE_X
    d.rectangle(left + SIZE / 2, TOP, SIZE / 2, SIZE / 2, role="orange", fill=("orange", 0.14), stroke=1)
    d.rectangle(left + SIZE / 2, TOP + SIZE / 4, SIZE / 4, SIZE / 4, role="orange", fill=("orange", 0.3), stroke=1)
    for i, j in ((0, 0), (1, 0), (0, 1), (1, 1)):
        d.rectangle(left + SIZE / 2 + i * SIZE / 8, TOP + SIZE / 4 + j * SIZE / 8, SIZE / 8, SIZE / 8, role="orange", stroke=1)
    d.line((left + SIZE / 2, TOP), (left + SIZE / 2, TOP + SIZE), role="orange", width=1)
    d.line((left, TOP + SIZE / 2), (left + SIZE, TOP + SIZE / 2), role="orange", width=1)
    d.line((left + 0.75 * SIZE, TOP), (left + 0.75 * SIZE, TOP + SIZE / 2), role="orange", width=1)
    d.line((left + SIZE / 2, TOP + SIZE / 4), (left + SIZE, TOP + SIZE / 4), role="orange", width=1)
    square(d, TREE_X, "orange", "density of the tree")
    d.rectangle(LIGHT_X, TOP, SIZE, SIZE, role="blue", fill=("blue", 0.06), stroke=1)
    d.circle(LIGHT_X + LAMP[0] * SIZE, TOP + LAMP[1] * SIZE, 11, role="blue", fill=("blue", 0.5))
    square(d, LIGHT_X, "blue", "incident light")
    d.text((TREE_X + LIGHT_X + SIZE) / 2, TOP + SIZE + 26, "one texel per direction, integral 1 each", role="green", anchor="middle")
    return d
