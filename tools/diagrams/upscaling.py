"""Frames take turns through the pixels of each block; histories follow the surfaces, and surfaces are sampled at every pixel."""

from draw import Drawing

SIZE = 26
TURNS = ((0, 0), (1, 1), (1, 0), (0, 1))


def grid(d, x, y, sampled, role):
    """Two by two blocks of two by two pixels."""
    for row in range(4):
        for column in range(4):
            is_sampled = (column % 2, row % 2) == sampled
            fill = (role, 0.35) if is_sampled else None
            d.rectangle(x + SIZE * column, y + SIZE * row, SIZE, SIZE, role="faint", fill=fill, stroke=1)
            if is_sampled:
                d.dot(x + SIZE * (column + 0.5), y + SIZE * (row + 0.5), role=role)
    for row in range(2):
        for column in range(2):
            d.rectangle(x + 2 * SIZE * column, y + 2 * SIZE * row, 2 * SIZE, 2 * SIZE, stroke=2)


def draw():
    d = Drawing(632, 322, "Temporal upscaling: one path per block and frame, accumulated along the motion into the full image")
    for i, turn in enumerate(TURNS):
        x = 24 + 128 * i
        grid(d, x, 40, turn, "blue")
        d.text(x + 2 * SIZE, 28, f"frame {i + 1}", anchor="middle")
        d.arrow((x + 2 * SIZE, 40 + 4 * SIZE + 4), (x + 2 * SIZE, 190), role="orange", width=2)
    d.text(524, 86, "paths,", role="blue")
    d.text(524, 106, "in a quarter", role="blue")
    d.text(524, 126, "of the pixels", role="blue")
    d.box(24, 194, 488, 40, "history, moved with the surfaces and validated", role="orange", fill=("orange", 0.12))
    d.box(24, 262, 230, 40, "surfaces of all pixels", fill=("ink", 0.06))
    d.box(340, 262, 172, 40, "full image", role="green", fill=("green", 0.12))
    d.arrow((254, 282), (336, 282), width=2)
    d.text(295, 274, "filter", anchor="middle")
    d.arrow((426, 234), (426, 258), role="orange", width=2)
    return d
