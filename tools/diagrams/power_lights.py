"""An alias table: columns of equal probability, each shared by at most two lights."""

from draw import Drawing

WIDTH = 66
BASE = 210


def column(d, x, y, width, height, label, role):
    d.rectangle(x, y - height, width, height, role=role, fill=(role, 0.18))
    if label:
        d.text(x + width / 2, y - height / 2 + 6, label, role=role, anchor="middle")


def draw():
    d = Drawing(640, 300, "An alias table: four columns of equal width, each shared by at most two lights")
    d.text(8, 24, "power of each light", style="bold")
    mean = 64
    powers = (1.0, 0.4, 2.2, 0.4)
    roles = ("ink", "blue", "orange", "faint")
    for i, (power, role) in enumerate(zip(powers, roles)):
        column(d, 14 + 56 * i, BASE, 44, mean * power, "", role)
        d.text(36 + 56 * i, BASE + 24, str(i + 1), role=role, anchor="middle", style="bold")
    d.line((8, BASE - mean), (240, BASE - mean), role="faint", dashed=True)
    d.text(8, BASE - mean - 8, "mean", role="faint")
    d.arrow((250, 150), (316, 150), role="orange", width=2.5)
    left = 340
    d.text(left, 24, "alias table", style="bold")
    # Light 3 fills the columns of the weak lights up to the mean.
    height = 120
    for i, (share, own, alias) in enumerate(((1.0, 0, 0), (0.4, 1, 2), (1.0, 2, 2), (0.4, 3, 2))):
        x = left + WIDTH * i
        column(d, x, BASE, WIDTH, height * share, str(own + 1), roles[own])
        if share < 1:
            column(d, x, BASE - height * share, WIDTH, height * (1 - share), str(alias + 1), roles[alias])
    d.arrow((left + 96, BASE + 56), (left + 96, BASE + 6), role="green", width=2.5)
    d.text(left, BASE + 78, "u chooses a column, its rest a part", role="green")
    d.line((left, BASE + 8), (left, BASE + 18), role="faint")
    d.line((left + 4 * WIDTH, BASE + 8), (left + 4 * WIDTH, BASE + 18), role="faint")
    d.line((left, BASE + 13), (left + 4 * WIDTH, BASE + 13), role="faint")
    d.text(left, BASE + 36, "u = 0", role="faint")
    d.text(left + 4 * WIDTH, BASE + 36, "u = 1", role="faint", anchor="end")
    return d
