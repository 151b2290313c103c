"""Each level of the filter doubles the distance of the taps. Edges stop the filter; noise widens its luminance weights."""

from draw import Drawing

PIXELS = 21
LEFT, SIZE = 24, 17
CENTRE = 9
EDGE = 16  # first pixel of another surface


def x_of(pixel):
    return LEFT + SIZE * (pixel + 0.5)


def levels(d):
    for level, top in enumerate((70, 140, 210)):
        step = 1 << level
        taps = [CENTRE + k * step for k in (-2, -1, 1, 2)]
        for pixel in range(PIXELS):
            role, opacity = ("faint", 0.3) if pixel >= EDGE else ("faint", 0.0)
            if pixel in taps and pixel < EDGE:
                role, opacity = "blue", 0.35
            if pixel == CENTRE:
                role, opacity = "green", 0.5
            d.rectangle(LEFT + SIZE * pixel, top, SIZE, SIZE, role="faint", fill=(role, opacity), stroke=1)
        for tap in taps:
            height = 8 + 6 * abs(tap - CENTRE) ** 0.6
            beyond = tap >= EDGE
            d.curve((x_of(tap), top - 2), ((x_of(tap) + x_of(CENTRE)) / 2, top - 2 - 2 * height), (x_of(CENTRE), top - 2),
                    role="faint" if beyond else "blue", dashed=beyond)
    d.line((LEFT + SIZE * EDGE, 48), (LEFT + SIZE * EDGE, 236), width=2.5)
    d.text(LEFT, 28, "taps 1, 2, 4, 8 and 16 pixels apart")
    d.text(LEFT + SIZE * EDGE, 256, "edge of a surface", anchor="middle")


def weights(d, x, base, width, label, role):
    """The weight of a tap, by its difference in light."""
    d.arrow((x, base), (x + 192, base))
    points = []
    for i in range(61):
        difference = i / 20 - 1.5
        points.append((x + 62 + 40 * difference, base - 62 * (1 + abs(difference) / width / 8) ** -8))
    d.line(*points, role=role, width=2.5)
    d.line((x + 62, base), (x + 62, base - 70), role="faint", dashed=True)
    d.text(x + 194, base - 44, label, role=role, anchor="end")


def draw():
    d = Drawing(624, 276, "SVGF: levels with taps twice as far apart each, which stop at edges and reach as far as the noise of the light")
    levels(d)
    d.text(424, 28, "weight of a tap")
    weights(d, 424, 118, 0.45, "few samples", "blue")
    weights(d, 424, 220, 0.1, "many", "orange")
    d.text(424, 256, "by its difference in light")
    return d
