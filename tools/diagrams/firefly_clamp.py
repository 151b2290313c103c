"""A sample far brighter than its neighbours is scaled down to a multiple of their mean; the light above is lost."""

from draw import Drawing

NEIGHBOURS = (14, 22, 9, 18, 25, 12, 0, 16, 20, 8, 24, 13, 17)
BASE, LEFT, STEP = 262, 60, 30
MEAN = sum(NEIGHBOURS) / (len(NEIGHBOURS) - 1)
LIMIT = 8 * MEAN


def draw():
    d = Drawing(552, 296, "Firefly clamp: a sample far brighter than its neighbours is scaled down to a multiple of their mean")
    d.arrow((LEFT, BASE), (LEFT, 34))
    d.text(LEFT, 24, "luminance Y", anchor="middle")
    for i, value in enumerate(NEIGHBOURS):
        x = LEFT + 14 + STEP * i
        if value:
            d.rectangle(x, BASE - value, 18, value, role="blue", fill=("blue", 0.3))
            continue
        d.rectangle(x, BASE - LIMIT, 18, LIMIT, role="green", fill=("green", 0.3))
        d.rectangle(x, 44, 18, BASE - LIMIT - 44, role="ink", dashed=True)
        d.arrow((x + 9, 60), (x + 9, BASE - LIMIT - 4), width=2)
        d.text(x + 30, 66, "lost light")
        d.text(x + 30, 186, "kept sample L′", role="green")
    right = LEFT + 14 + STEP * len(NEIGHBOURS)
    d.line((LEFT, BASE), (right, BASE), width=2)
    d.line((LEFT, BASE - LIMIT), (right, BASE - LIMIT), role="orange", dashed=True, width=2)
    d.line((LEFT, BASE - MEAN), (right, BASE - MEAN), role="orange", dashed=True, width=2)
    d.text(right + 8, BASE - LIMIT + 5, "8 · Ȳ", role="orange")
    d.text(right + 8, BASE - MEAN + 5, "mean Ȳ", role="orange")
    d.text((LEFT + right) / 2, BASE + 24, "neighbours, in 5 × 5 pixels", role="blue", anchor="middle")
    return d
