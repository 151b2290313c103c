"""A path survives with a probability that rises with the variance of its cell; a pixel whose path is culled shows the cell."""

from draw import Drawing

FLOOR = 176
V0, V1 = 0.5, 2.0
LARGEST = 5.0
LEFT, RIGHT, TOP, BOTTOM = 376, 596, 62, 212
SPREAD = (((112, FLOOR), "culled"), ((132, FLOOR), "culled"), ((236, FLOOR), (214, 60)), ((256, FLOOR), (322, 92)))


def survival(v):
    """Eq. 4.2, with the default floor of 0.1."""
    width = V1 - V0
    e = 1 - width / 8
    s = min(max(((v - (V0 + V1) / 2) / (5 * width) + e / 2) / e, 0), 1)
    return max(0.1, s * s * (3 - 2 * s))


def at(v, p):
    return LEFT + (RIGHT - LEFT) * v / LARGEST, BOTTOM - (BOTTOM - TOP) * p


def draw():
    d = Drawing(620, 300, "Adaptive path space filtering: the variance of a cell decides how many of its paths are followed")
    camera = (36, 50)
    d.line((60, FLOOR), (310, FLOOR), width=2)
    d.rectangle(86, FLOOR - 34, 68, 68, role="orange", fill=("orange", 0.16))
    d.rectangle(212, FLOOR - 34, 68, 68, role="orange", fill=("orange", 0.16))
    for point, end in SPREAD:
        d.line(camera, point, role="blue")
        if end != "culled":
            d.arrow(point, end, role="blue")
        d.dot(*point, role="blue")
    d.camera(*camera, angle=38)
    d.text(24, 34, "camera")
    d.text(120, 234, "v small", role="orange", anchor="middle")
    d.text(120, 258, "often culled:", anchor="middle")
    d.text(120, 278, "pixel shows c̄", role="green", anchor="middle")
    d.text(246, 234, "v large", role="orange", anchor="middle")
    d.text(246, 258, "followed:", anchor="middle")
    d.text(246, 278, "feeds the cell", role="blue", anchor="middle")

    d.arrow((LEFT, BOTTOM), (LEFT, 40))
    d.arrow((LEFT, BOTTOM), (RIGHT + 14, BOTTOM))
    d.line(at(0, 1), at(LARGEST, 1), role="faint", dashed=True)
    d.text(LEFT - 10, TOP + 6, "1", role="faint", anchor="end")
    for v, label in ((V0, "v0"), (V1, "v1")):
        d.line((at(v, 0)[0], BOTTOM), at(v, survival(v)), role="faint", dashed=True)
        d.text(at(v, 0)[0], BOTTOM + 22, label, role="faint", anchor="middle")
    points = [at(LARGEST * i / 50, survival(LARGEST * i / 50)) for i in range(51)]
    d.line(*points, role="green", width=2.5)
    d.text(392, 34, "probability to follow", role="green")
    d.text(RIGHT + 14, BOTTOM + 46, "variance v of the cell", role="orange", anchor="end")
    return d
