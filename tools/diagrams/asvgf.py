"""A path of the previous frame is traced again from the same surface point with the same numbers; the filtered difference sets the weight of the history."""

from draw import Drawing

SIZE = 22


def strata(d, x, y, chosen, role):
    """Two by two strata of three by three pixels, one pixel of each chosen."""
    for row in range(6):
        for column in range(6):
            stratum = (row // 3) * 2 + column // 3
            is_chosen = (column % 3, row % 3) == chosen[stratum]
            d.rectangle(x + SIZE * column, y + SIZE * row, SIZE, SIZE, role="faint", fill=(role, 0.35) if is_chosen else None, stroke=1)
            if is_chosen:
                d.dot(x + SIZE * (column + 0.5), y + SIZE * (row + 0.5), role=role)
    for row in range(2):
        for column in range(2):
            d.rectangle(x + 3 * SIZE * column, y + 3 * SIZE * row, 3 * SIZE, 3 * SIZE, stroke=2)


def scene(d, x, lamp, label, role):
    """A path from the floor to a lamp, which has moved."""
    d.line((x, 168), (x + 150, 168), width=2.5)
    d.dot(x + 60, 168, role=role)
    d.line((x + lamp - 16, 56), (x + lamp + 16, 56), role="orange", width=4)
    d.arrow((x + 60, 164), (x + lamp, 60), role=role, width=2)
    d.text(x + 75, 36, label, anchor="middle")


def draw():
    d = Drawing(632, 330, "A-SVGF: one pixel of each stratum is traced again with its own random numbers, and the difference shortens the history")
    d.text(24, 36, "previous frame")
    strata(d, 24, 46, ((1, 0), (2, 2), (0, 1), (1, 1)), "blue")
    d.arrow((160, 112), (196, 112), width=2)
    scene(d, 204, 40, "path, previous frame", "blue")
    d.arrow((362, 112), (398, 112), width=2)
    scene(d, 406, 104, "path traced again", "green")
    d.text(279, 194, "luminance before", role="blue", anchor="middle")
    d.text(481, 194, "luminance now", role="green", anchor="middle")
    d.box(24, 222, 250, 40, "δ = now − before", fill=("ink", 0.06))
    d.arrow((274, 242), (320, 242), width=2)
    d.box(324, 222, 284, 40, "à-trous filter of δ and of Δ", fill=("ink", 0.06))
    d.arrow((466, 262), (466, 280), width=2)
    d.box(324, 284, 284, 36, "λ = min(1, |δ| / Δ)", role="green", fill=("green", 0.12))
    d.arrow((324, 302), (278, 302), width=2)
    d.box(24, 284, 250, 36, "α ← (1 − λ) α + λ", role="orange", fill=("orange", 0.12))
    return d
