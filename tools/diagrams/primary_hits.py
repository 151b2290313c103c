"""Camera rays of two rows of neighbouring pixels form a packet. Each pixel's hit is found once and read by all later passes."""

from draw import Drawing


def pixel(column, row):
    """Of the image plane, seen from the side."""
    return 84 + 17 * column, 62 + 27 * row + 8 * column


def surface(column, row):
    return 226 + 22 * column, 50 + 33 * row + 9 * column


def quad(at, column, row, columns=1, rows=1):
    return at(column, row), at(column + columns, row), at(column + columns, row + rows), at(column, row + rows)


def draw():
    d = Drawing(630, 256, "Primary hits: the camera rays of eight neighbouring pixels are traced as one packet; all later passes read the hits")
    d.polygon(*quad(surface, 0, 0, 4, 4), fill=("ink", 0.12))
    for row in range(4):
        for column in range(4):
            packed = row in (1, 2)
            d.polygon(*quad(pixel, column, row), role="blue" if packed else "faint", fill=("blue", 0.2) if packed else None, width=1)
    for row in (1, 2):
        for column in range(4):
            d.line(pixel(column + 0.5, row + 0.5), surface(column + 0.5, row + 0.5), role="blue", width=1.2)
            d.dot(*surface(column + 0.5, row + 0.5), role="blue", radius=3)
    d.camera(30, 128, angle=0)
    d.text(24, 30, "8 pixels: one packet", role="blue")
    d.text(280, 244, "first surface", anchor="middle")
    d.arrow((322, 130), (356, 130), role="orange", width=2)
    d.text(434, 60, "Hit", role="orange", anchor="middle", style="bold")
    d.box(366, 74, 136, 112, "instance", "triangle", "barycentrics", "distance", role="orange", fill=("orange", 0.16))
    for y, label in ((84, "paths"), (130, "surfaces"), (176, "features")):
        d.arrow((506, 130), (536, y), role="green")
        d.text(542, y + 5, label, role="green")
    d.text(434, 210, "20 bytes per pixel", role="faint", anchor="middle")
    return d
