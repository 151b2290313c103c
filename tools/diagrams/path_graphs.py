"""A path sums the variance that its vertices add to the pixel. Where the sum would exceed a constant, the cell of that
vertex replaces the rest of the path, except for a share α, which the next cell replaces."""

from draw import Drawing

FLOOR, CEILING = 176, 48
VERTICES = ((150, FLOOR), (250, CEILING), (350, FLOOR), (450, CEILING))
BAR = 240
SEGMENTS = (("x1", 120), ("x2", 120), ("x3", 170))
CONST = 314


def cell(d, x, y):
    d.rectangle(x - 30, y - 20, 60, 40, role="orange", fill=("orange", 0.16))


def draw():
    d = Drawing(640, 310, "Path graphs: a path ends in a cell where the variance that it brings into the pixel would exceed a constant")
    for x, y in VERTICES:
        cell(d, x, y)
    d.line((70, FLOOR), (560, FLOOR), width=2)
    d.line((180, CEILING), (560, CEILING), width=2)
    camera = (36, 60)
    d.line(camera, *VERTICES[:3], role="blue", width=2)
    d.line(*VERTICES[2:], role="blue", dashed=True)
    for x, y in VERTICES:
        d.dot(x, y, role="blue")
    d.camera(*camera, angle=45)
    d.text(20, 44, "camera")
    for (x, y), label in zip(VERTICES, ("x1", "x2", "x3", "x4")):
        d.text(x, y + (38 if y == FLOOR else -26), label, role="blue", anchor="middle")
    d.text(396, 200, "1 − α from this cell", role="orange")
    d.text(492, 84, "α from this cell", role="orange")

    left = 24
    for i, (label, width) in enumerate(SEGMENTS):
        shown = min(left + width, CONST) - left
        d.rectangle(left, BAR, shown, 28, role="blue", fill=("blue", 0.12 + 0.1 * i))
        if shown < width:
            d.rectangle(CONST, BAR, width - shown, 28, role="orange", fill=("orange", 0.16), dashed=True)
        d.text(left + shown / 2, BAR + 20, label, role="blue", anchor="middle")
        left += width
    d.line((CONST, BAR - 10), (CONST, BAR + 40), width=2)
    d.text(CONST, BAR + 56, "const", anchor="middle")
    d.text(24, BAR + 52, "variance V of the path", role="blue")
    d.text(left + 12, BAR + 20, "left to the cells", role="orange")
    return d
