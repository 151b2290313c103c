"""Paths of several pixels add their samples to one cell of the hash grid; each of these pixels shows the cell's mean."""

from draw import Drawing

FLOOR = 206
CELL = 84


def draw():
    d = Drawing(600, 300, "Path space filtering: paths of several pixels add samples to one cell, whose mean they all show")
    d.rectangle(430, 34, 130, 12, fill=("ink", 0.15))
    d.text(495, 24, "light", anchor="middle")
    for i in range(4):
        d.rectangle(172 + CELL * i, FLOOR - CELL / 2, CELL, CELL, role="faint", dashed=True)
    d.rectangle(172 + CELL, FLOOR - CELL / 2, CELL, CELL, role="orange", fill=("orange", 0.16))
    d.line((130, FLOOR), (590, FLOOR), width=2)
    camera = (48, 62)
    for i, x in enumerate((272, 298, 384)):
        d.line(camera, (x, FLOOR), role="blue")
        d.arrow((x, FLOOR), (452 + 40 * i, 56), role="blue")
        d.dot(x, FLOOR, role="blue")
    d.camera(*camera, angle=32)
    d.text(24, 48, "camera")
    d.text(24, 152, "throughput T", role="blue")
    d.text(506, 122, "sample c", role="blue")
    d.arrow((384, FLOOR), (326, FLOOR), role="orange", width=2.5)
    d.text(350, FLOOR + 22, "jitter", role="orange")
    d.text(298, FLOOR + 22, "x", anchor="middle")
    d.arrow((222, 276), (262, 232), role="orange")
    d.text(24, 290, "the cell averages all samples: c̄", role="orange")
    d.text(580, 290, "pixel = L_unfiltered + T · ρ(x) · c̄", role="green", anchor="end")
    return d
