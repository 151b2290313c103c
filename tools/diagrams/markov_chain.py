"""The drawn cells hold chains, each with a target: lobes towards them and the BSDF make up the density. The direction taken moves the
chain that chose it."""

from draw import Drawing

FLOOR = 220
X = (150, FLOOR)
Y = (470, FLOOR)
LAMP = (300, 60)


def lobe(d, origin, end, spread, role):
    (x, y), (u, v) = origin, end
    dx, dy = u - x, v - y
    d.polygon(origin, (u - spread * dy, v + spread * dx), (u + spread * dy, v - spread * dx), role=role, fill=(role, 0.16))


def draw():
    d = Drawing(620, 326, "Markov chain path guiding: chains in the cells around a vertex remember targets, and the path's direction moves one of them")
    d.rectangle(LAMP[0] - 34, LAMP[1] - 14, 68, 10, role="ink", fill=("ink", 0.15))
    d.line((24, FLOOR), (600, FLOOR), width=2)
    for left in (112, 140, 168):
        d.rectangle(left - 14, FLOOR - 14, 28, 28, role="orange", fill=("orange", 0.12))
    lobe(d, X, (272, 72), 0.1, "orange")
    lobe(d, X, (52, 96), 0.24, "orange")
    d.circle(X[0], FLOOR - 40, 36, role="faint", dashed=True)
    d.arrow(X, (LAMP[0] - 6, LAMP[1] + 4), role="green", width=2.5)
    d.dot(*X)
    d.text(X[0], FLOOR + 36, "x: five drawn cells", role="orange", anchor="middle")
    d.text(196, FLOOR - 24, "BSDF: β", role="faint")
    d.text(24, 70, "s₂ vMF₂", role="orange")
    d.text(170, 96, "s₁ vMF₁", role="orange")
    d.text(LAMP[0] + 44, LAMP[1] - 4, "target: a point", role="green")
    lobe(d, Y, (336, 72), 0.1, "orange")
    d.dot(*Y)
    d.text(Y[0], FLOOR + 36, "the same chain, seen elsewhere", role="orange", anchor="middle")
    d.text(310, 288, "accepted with probability score / mean s: the chain moves to the new", role="green", anchor="middle")
    d.text(310, 310, "target, and is written to one adaptive and one static cell", role="green", anchor="middle")
    return d
