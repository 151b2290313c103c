"""Reservoirs of a pixel, of its surface in the previous frame and of its neighbours become one."""

from draw import Drawing

SIZE = 24


def grid(d, x, y, title):
    for row in range(5):
        for column in range(5):
            d.rectangle(x + SIZE * column, y + SIZE * row, SIZE, SIZE, role="faint", stroke=1)
    d.text(x + 2.5 * SIZE, y - 12, title, anchor="middle")


def cell(d, x, y, column, row, role):
    d.rectangle(x + SIZE * column, y + SIZE * row, SIZE, SIZE, role=role, fill=(role, 0.35), stroke=1)


def draw():
    d = Drawing(632, 330, "ReSTIR DI: a pixel combines its candidates with the reservoir of its surface in the previous frame, then with those of neighbours")
    grid(d, 30, 44, "previous frame")
    grid(d, 256, 44, "this frame")
    grid(d, 482, 44, "result")
    cell(d, 30, 44, 1, 2, "orange")
    cell(d, 256, 44, 2, 2, "blue")
    for column, row in ((0, 1), (4, 1), (3, 4)):
        cell(d, 256, 44, column, row, "orange")
    cell(d, 482, 44, 2, 2, "green")
    d.arrow((30 + 2 * SIZE, 44 + 2.5 * SIZE), (256 + 2 * SIZE, 44 + 2.5 * SIZE), role="orange", width=2)
    d.text(203, 94, "motion", role="orange", anchor="middle")
    d.arrow((256 + 3 * SIZE, 44 + 2.5 * SIZE), (482 + 2 * SIZE, 44 + 2.5 * SIZE), role="green", width=2)
    d.text(430, 94, "pairwise", role="green", anchor="middle")
    d.box(30, 186, 270, 56, "1. own candidates, as with ris", "one shadow ray", role="blue", fill=("blue", 0.12))
    d.box(332, 186, 270, 56, "2. history: balance heuristic", "two shadow rays", role="orange", fill=("orange", 0.12))
    d.box(30, 258, 270, 56, "3. k neighbours: pairwise", "2k shadow rays", role="orange", fill=("orange", 0.12))
    d.box(332, 258, 270, 56, "4. light = f · W", "history of the next frame", role="green", fill=("green", 0.12))
    return d
