"""One pixel of each block traces an update path, whose vertices fill cells. The paths of all pixels end in a cell after their first rough bounce, if segment and
cone are larger than the cell."""

from draw import Drawing

FLOOR, CEILING = 204, 84
PIXEL = 11


def cell(d, x, y, known=True):
    d.rectangle(x - 26, y - 17, 52, 34, role="orange", fill=("orange", 0.16) if known else None, dashed=not known)


def block(d, x, y, chosen):
    """Five by five pixels, one of them chosen."""
    for row in range(5):
        for column in range(5):
            is_chosen = (column, row) == chosen
            d.rectangle(x + PIXEL * column, y + PIXEL * row, PIXEL, PIXEL, role="faint", fill=("orange", 0.8) if is_chosen else None, stroke=0.75)


def surfaces(d, left, right):
    d.line((left, FLOOR), (right, FLOOR), width=2)
    d.line((left + 50, CEILING), (right, CEILING), width=2)


def update(d):
    d.text(20, 24, "update: 1 pixel of 25", role="orange")
    block(d, 20, 84, (3, 1))
    vertices = ((120, FLOOR), (180, CEILING), (240, FLOOR), (296, CEILING))
    for x, y in vertices:
        cell(d, x, y)
    surfaces(d, 88, 326)
    d.line((20 + 3.5 * PIXEL, 84 + 1.5 * PIXEL), *vertices[:3], role="orange", width=2)
    d.arrow(vertices[2], vertices[3], role="orange", width=2)
    for x, y in vertices[:3]:
        d.dot(x, y, role="orange")
    d.curve((232, FLOOR + 20), (180, FLOOR + 44), (130, FLOOR + 20), role="orange", dashed=True)
    d.text(180, FLOOR + 54, "light to earlier cells", role="orange", anchor="middle")
    d.text(296, CEILING - 24, "ends here", role="orange", anchor="middle")


def query(d):
    d.text(366, 24, "camera paths: all pixels", role="blue")
    camera, first, last = (366, 98), (448, FLOOR), (560, CEILING)
    cell(d, *last)
    cell(d, *first, known=False)
    surfaces(d, 400, 624)
    d.polygon(first, (last[0] - 60, CEILING), (last[0] + 60, CEILING), role="blue", fill=("blue", 0.1), width=0.5)
    d.line(camera, first, last, role="blue", width=2)
    d.camera(*camera, angle=50, role="blue")
    d.dot(*first, role="blue")
    d.dot(*last, role="green")
    d.text(470, FLOOR + 34, "first rough surface: no cell is read", role="blue", anchor="middle")
    d.text(last[0], CEILING - 24, "ρ · c̄ ends the path", role="green", anchor="middle")
    d.text(530, 152, "cone ≥ edge", role="blue")


def draw():
    d = Drawing(640, 336, "SHaRC: sparse update paths fill the cells, in which the paths of all pixels end after their first rough bounce")
    update(d)
    query(d)
    d.box(60, 284, 520, 36, "after the frame: c̄ averages the samples of the last F frames", role="green", fill=("green", 0.12))
    return d
