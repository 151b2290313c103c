"""Denoisers filter light, not radiance: the albedo is divided out first and multiplied back, so textures stay sharp."""

from draw import Drawing

PIXELS = 24
WIDTH, HEIGHT = 112, 84
TOP, LOW = 56, 206


def albedo(i):
    return 0.9 if i // 3 % 2 == 0 else 0.35


def lighting(i):
    return 0.92 - 0.55 * i / PIXELS


def noisy(i):
    return max(lighting(i) + 0.55 * (((i * i * 37 + i * 61) % 101) / 101 - 0.5), 0.04)


def plot(d, x, y, values, role, label):
    d.rectangle(x, y, WIDTH, HEIGHT, role="faint", stroke=1)
    step = WIDTH / PIXELS
    points = []
    for i, value in enumerate(values):
        level = y + HEIGHT - HEIGHT * min(value, 1.15) / 1.2
        points += [(x + step * i, level), (x + step * (i + 1), level)]
    d.line(*points, role=role, width=2)
    d.text(x + WIDTH / 2, y - 10, label, role=role, anchor="middle")


def draw():
    d = Drawing(604, 306, "Shared steps of denoisers: albedo is divided out before the filter and multiplied back after it")
    pixels = range(PIXELS)
    columns = (24, 188, 352)
    plot(d, columns[0], TOP, [albedo(i) * noisy(i) for i in pixels], "blue", "sample L − Lₑ")
    plot(d, columns[1], TOP, [albedo(i) for i in pixels], "ink", "albedo ρ")
    plot(d, columns[2], TOP, [noisy(i) for i in pixels], "blue", "light E")
    d.text(162, TOP + 50, "÷", anchor="middle", style="bold")
    d.text(326, TOP + 50, "=", anchor="middle", style="bold")
    plot(d, columns[2], LOW, [lighting(i) for i in pixels], "orange", "filtered E")
    plot(d, columns[1], LOW, [albedo(i) for i in pixels], "ink", "albedo ρ")
    plot(d, columns[0], LOW, [albedo(i) * lighting(i) for i in pixels], "green", "image − Lₑ")
    d.text(326, LOW + 50, "×", anchor="middle", style="bold")
    d.text(162, LOW + 50, "=", anchor="middle", style="bold")
    side = columns[2] + WIDTH
    (x0, y0), (x1, y1), (x2, y2) = (side + 8, TOP + 44), (side + 72, 151), (side + 8, LOW + 42)
    ts = [i / 12 for i in range(13)]
    d.arrow(*[((1 - t) ** 2 * x0 + 2 * t * (1 - t) * x1 + t * t * x2, (1 - t) ** 2 * y0 + 2 * t * (1 - t) * y1 + t * t * y2) for t in ts],
            role="orange", width=2.5)
    d.text(side + 50, 174, "history", role="orange")
    d.text(side + 50, 196, "and filter", role="orange")
    return d
