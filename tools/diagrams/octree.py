"""Leaves with many samples in the last frame are split, siblings with few are merged. An inner node is one word; the index of
a leaf addresses all arrays. (Drawn in two dimensions: four children instead of eight.)"""

from draw import Drawing

TOP = 52
SIZE = 160
EDGE = SIZE / 4
SURFACE = ((0, 0.86), (0.18, 0.74), (0.36, 0.6), (0.5, 0.47), (0.62, 0.37), (0.75, 0.29), (0.88, 0.2), (1, 0.16))
SAMPLES = (0.12, 0.51, 0.54, 0.57, 0.6, 0.63, 0.66, 0.69, 0.72, 0.84)


def height(u):
    for (u0, v0), (u1, v1) in zip(SURFACE, SURFACE[1:]):
        if u <= u1:
            return v0 + (v1 - v0) * (u - u0) / (u1 - u0)


def cells(d, x, split):
    d.rectangle(x + 2 * EDGE, TOP + EDGE, EDGE, EDGE, role="orange", fill=("orange", 0.25))
    d.rectangle(x, TOP + 2 * EDGE, 2 * EDGE, 2 * EDGE, role="faint", fill=("faint", 0.22))
    d.rectangle(x, TOP, SIZE, SIZE, role="faint")
    for column, row, edge in ((0, 0, SIZE), *split):
        left, top = x + column * edge, TOP + row * edge
        d.line((left + edge / 2, top), (left + edge / 2, top + edge), role="faint")
        d.line((left, top + edge / 2), (left + edge, top + edge / 2), role="faint")
    d.line(*[(x + u * SIZE, TOP + v * SIZE) for u, v in SURFACE], width=2.5)


def draw():
    d = Drawing(620, 320, "Octree: leaves with many samples of the last frame are split, siblings with few are joined")
    before, after = 24, 320
    cells(d, before, ((1, 0, SIZE / 2), (0, 1, SIZE / 2)))
    cells(d, after, ((1, 0, SIZE / 2), (2, 1, EDGE)))
    for u in SAMPLES:
        d.dot(before + u * SIZE, TOP + height(u) * SIZE, role="blue")
    d.text(before, 36, "samples of a frame", role="blue")
    d.text(after, 36, "leaves of the next")
    d.step(before + SIZE + 16, after - 16, 106, "many: split", role="orange")
    d.step(before + SIZE + 16, after - 16, 176, "few: join", role="faint")
    d.text(after + SIZE + 10, 83, "surface")

    d.text(24, 250, "node n")
    d.rectangle(92, 230, 190, 30, fill=("ink", 0.06))
    d.text(187, 251, "first inner child", anchor="middle")
    d.rectangle(282, 230, 110, 30, role="orange", fill=("orange", 0.16))
    d.text(337, 251, "leaf mask", role="orange", anchor="middle")
    d.text(187, 280, "24 bits", role="faint", anchor="middle")
    d.text(337, 280, "8 bits", role="faint", anchor="middle")
    d.text(24, 310, "leaf c of node n: entry 8 n + c of each array", role="orange")
    return d
