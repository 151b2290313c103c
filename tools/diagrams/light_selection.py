"""The probabilities with which each strategy chooses among four lights at one point."""

from draw import Drawing

FLOOR = 236
BAR = 30
FULL = 70  # height of a bar of probability 1


def scene(d):
    d.line((10, FLOOR), (296, FLOOR), width=2)
    d.rectangle(196, 96, 14, FLOOR - 96, fill=("ink", 0.2))
    d.dot(92, FLOOR)
    d.text(92, FLOOR + 24, "x", anchor="middle")
    for i, (x, y, radius) in enumerate(((44, 62, 13), (112, 142, 6), (132, 62, 13), (262, 62, 13))):
        if i == 2:
            d.polygon((x - 14, y), (x + 14, y), (x + 10, y - 8), (x - 10, y - 8), fill=("ink", 0.12))
            for side in (-8, 0, 8):
                d.line((x + side, y - 12), (x + 1.5 * side, y - 20), role="faint")
        else:
            d.circle(x, y, radius, fill=("ink", 0.12))
        d.text(x + radius + 6, y + 6, str(i + 1), style="bold")
    d.text(30, 98, "strong", role="faint")
    d.text(66, 170, "weak, near", role="faint")
    d.text(98, 88, "faces away", role="faint")
    d.text(228, 98, "hidden", role="faint")


def chart(d, y, name, probabilities):
    d.text(432, y - 6, name, anchor="end")
    d.line((446, y), (446 + 4 * (BAR + 12), y), role="faint")
    for i, p in enumerate(probabilities):
        height = max(FULL * p, 0)
        if height > 0:
            d.rectangle(452 + (BAR + 12) * i, y - height, BAR, height, role="green", fill=("green", 0.3))


def draw():
    d = Drawing(640, 300, "Probabilities with which each strategy chooses among four lights at one point")
    scene(d)
    d.text(446, 22, "P(light | x)", role="green")
    chart(d, 70, "uniform", (0.25, 0.25, 0.25, 0.25))
    chart(d, 130, "power", (0.32, 0.04, 0.32, 0.32))
    chart(d, 196, "light-tree", (0.42, 0.36, 0, 0.22))
    chart(d, 262, "static-lists, vlc", (0.54, 0.4, 0.03, 0.03))
    for i in range(4):
        d.text(452 + (BAR + 12) * i + BAR / 2, 284, str(i + 1), anchor="middle", style="bold")
    return d
