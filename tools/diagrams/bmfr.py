"""Within a block, a least-squares fit of noisy light to normals and positions: smooth, with steps where the normals have them."""

from draw import Drawing

PIXELS = 32
LEFT, STEP, BASE, HEIGHT = 76, 16, 286, 130
EDGE = 18  # first pixel of the slope


def x_of(pixel):
    return LEFT + STEP * (pixel + 0.5)


def features(pixel):
    p = 2 * pixel / (PIXELS - 1) - 1
    return [1.0, 1.0 if pixel >= EDGE else 0.0, p, p * p]


def light(pixel):
    noise = ((pixel * pixel * 37 + pixel * 61) % 101) / 101 - 0.5
    true = 0.86 - 0.5 * (pixel / PIXELS) ** 2 if pixel < EDGE else 0.22 + 0.5 * ((pixel - EDGE) / PIXELS)
    return true + 0.52 * noise


def solve(rows, values):
    """Least squares by the normal equations, which four columns allow."""
    n = len(rows[0])
    a = [[sum(r[i] * r[j] for r in rows) for j in range(n)] + [sum(r[i] * v for r, v in zip(rows, values))] for i in range(n)]
    for i in range(n):
        for k in range(i + 1, n):
            scale = a[k][i] / a[i][i]
            a[k] = [x - scale * y for x, y in zip(a[k], a[i])]
    result = [0.0] * n
    for i in reversed(range(n)):
        result[i] = (a[i][n] - sum(a[i][j] * result[j] for j in range(i + 1, n))) / a[i][i]
    return result


def surface(d):
    ground, right = 94, LEFT + STEP * PIXELS
    edge = LEFT + STEP * EDGE
    end = (right, ground - 60)
    d.line((LEFT, ground), (edge, ground), end, width=2.5)
    d.arrow((LEFT + 120, ground), (LEFT + 120, ground - 42))
    d.arrow((476, ground - 30), (465, ground - 70))
    d.text(LEFT + 134, ground - 26, "n")
    d.text(478, ground - 54, "n′")
    d.text(LEFT + 16, ground - 12, "surface")
    d.line((edge, ground + 8), (edge, BASE), role="faint", dashed=True)


def draw():
    d = Drawing(620, 346, "BMFR: within a block, least squares explain noisy light by normals and positions")
    surface(d)
    right = LEFT + STEP * PIXELS
    d.rectangle(LEFT, BASE - HEIGHT - 24, STEP * PIXELS, HEIGHT + 24, role="faint", fill=("faint", 0.08))
    d.text(LEFT - 12, BASE - HEIGHT + 10, "light E", anchor="end")
    values = [light(i) for i in range(PIXELS)]
    beta = solve([features(i) for i in range(PIXELS)], values)
    for i, value in enumerate(values):
        d.dot(x_of(i), BASE - HEIGHT * value, role="blue")
    fit = [(x_of(i), BASE - HEIGHT * sum(b * f for b, f in zip(beta, features(i)))) for i in range(PIXELS)]
    d.line(*fit[:EDGE], role="green", width=3)
    d.line(*fit[EDGE:], role="green", width=3)
    d.text((LEFT + right) / 2, BASE + 22, "pixels of a block", anchor="middle")
    d.text(LEFT, BASE + 50, "samples", role="blue")
    d.text(right, BASE + 50, "fit = β₀ + β₁ · n + β₂ · p + β₃ · p²", role="green", anchor="end")
    return d
