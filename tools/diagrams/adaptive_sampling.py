"""The neighbours of a pixel estimate its noise; its probability of a sample is proportional to that, within bounds."""

from draw import Drawing

TOP = 56
BOTTOM = 206
NOISE = ((1, 1, 2, 4, 6), (1, 2, 3, 6, 8), (1, 2, 0, 7, 8), (2, 3, 6, 8, 7), (3, 6, 8, 7, 6))


def pool(d, x):
    size = 30
    for row, values in enumerate(NOISE):
        for column, value in enumerate(values):
            d.rectangle(x + size * column, TOP + size * row, size, size, role="faint", fill=("blue", 0.1 * value))
    d.rectangle(x + 2 * size, TOP + 2 * size, size, size, role="orange", stroke=2.5)
    d.text(x + 2.5 * size, TOP + 2.5 * size + 5.5, "i", anchor="middle", style="italic")
    d.text(x + 2.5 * size, TOP - 18, "24 neighbours", role="blue", anchor="middle")
    d.text(x + 2.5 * size, BOTTOM + 26, "noise σᵢ of one sample", role="orange", anchor="middle")


def probability(d, x):
    floor, ceiling, width = BOTTOM - 20, TOP + 12, 150
    d.arrow((x, BOTTOM), (x, TOP - 6))
    d.arrow((x, BOTTOM), (x + width + 16, BOTTOM))
    d.line((x, ceiling), (x + width, ceiling), role="faint", dashed=True)
    d.line((x, floor), (x + 15.7, floor), (x + 108, ceiling), (x + width, ceiling), role="orange", width=3)
    d.text(x - 8, ceiling + 5, "1", anchor="end")
    d.text(x - 8, floor + 5, "0.1 r", anchor="end")
    d.text(x + 50, 120, "s σ", role="orange", anchor="end")
    d.text(x - 8, TOP - 18, "probability p", role="orange")
    d.text(x + width / 2, BOTTOM + 26, "σ", anchor="middle")


def timeline(d, x):
    step = 13
    for y, label, period in ((96, "noisy pixel", 1), (166, "quiet pixel", 5)):
        d.text(x, y - 20, label)
        d.line((x, y), (x + 11 * step, y), role="faint")
        for i in range(12):
            if i % period == period // 2 and (period > 1 or i not in (4, 9)):
                d.dot(x + i * step, y, role="green", radius=5)
    d.text(x, TOP - 18, "samples", role="green")
    d.arrow((x, BOTTOM), (x + 11 * step + 6, BOTTOM))
    d.text(x + 5.5 * step, BOTTOM + 26, "frames", anchor="middle")


def draw():
    d = Drawing(634, 252, "Adaptive sampling: neighbours estimate the noise of a pixel, which sets the probability of its samples")
    pool(d, 24)
    d.arrow((182, 131), (214, 131), role="orange", width=2.5)
    probability(d, 266)
    d.arrow((432, 131), (464, 131), role="green", width=2.5)
    timeline(d, 480)
    return d
