"""A pool: light and camera subpaths both enter through the water, where no connection is possible, and merge on the floor."""

import math

from draw import Drawing

WATER = 130
FLOOR = 250
RADIUS = 52


def draw():
    d = Drawing(640, 340, "Below water, a camera subpath merges with the ends of the light subpaths within the radius r")
    d.polygon((30, WATER), (610, WATER), (610, FLOOR), (30, FLOOR), role="faint", fill=("blue", 0.08), width=1)
    d.line((30, FLOOR), (610, FLOOR), width=2)
    camera, entry, end = (70, 40), (190, WATER), (300, FLOOR)
    lamp = (520, 36)
    for surface, floor in (((446, WATER), 388), ((410, WATER), 332), ((384, WATER), 282), ((362, WATER), 236)):
        d.arrow(lamp, surface, role="orange", width=2)
        d.arrow(surface, (floor, FLOOR), role="orange", width=2)
    d.arrow(camera, entry, role="blue", width=2.5)
    d.arrow(entry, end, role="blue", width=2.5)
    d.camera(*camera, angle=37)
    d.circle(*lamp, 13, fill=("ink", 0.15))
    d.text(540, 42, "light")
    d.text(36, 26, "camera")
    d.text(604, WATER - 10, "water", anchor="end", role="faint")
    angles = [math.pi * i / 24 for i in range(25)]
    d.line(*((end[0] + RADIUS * math.cos(a), FLOOR - RADIUS * math.sin(a)) for a in angles), role="green", width=2, dashed=True)
    for floor in (388, 332, 282, 236):
        d.dot(floor, FLOOR, role="orange")
    d.dot(*end, role="blue")
    d.line((end[0], FLOOR + 14), (end[0] + RADIUS, FLOOR + 14), role="green")
    d.text(end[0] + RADIUS / 2, FLOOR + 34, "r", role="green", anchor="middle")
    for x, role, text in ((14, "blue", "camera subpath"), (204, "orange", "light subpaths")):
        d.line((x, 322), (x + 24, 322), role=role, width=2.5)
        d.text(x + 32, 328, text, role=role)
    d.line((384, 322), (412, 322), role="green", dashed=True)
    d.text(420, 328, "vertices within r merge", role="green")
    return d
