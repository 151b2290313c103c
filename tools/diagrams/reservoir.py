"""Several sampled lights, of which one is kept in a reservoir with the sum of all weights, and gets the only shadow ray."""

from draw import Drawing

FLOOR = 250
LAMPS = ((40, 60, 0.3), (100, 44, 1.0), (160, 44, 0.7), (224, 60, 0.15))
WEIGHTS = (0.3, 1.0, 0.7, 0.15)
CHOSEN = 1


def scene(d):
    d.line((10, FLOOR), (280, FLOOR), width=2)
    d.dot(130, FLOOR)
    d.text(130, FLOOR + 24, "primary hit", anchor="middle")
    for i, (x, y, strength) in enumerate(LAMPS):
        d.circle(x, y, 8 + 7 * strength, fill=("ink", 0.12))
        d.text(x, y - 14 - 7 * strength, str(i + 1), anchor="middle", style="bold")
        d.line((x, y + 20), (130, FLOOR - 4), role="green" if i == CHOSEN else "blue", width=2 if i == CHOSEN else 1, dashed=i != CHOSEN)
    d.line((10, 308), (38, 308), role="blue", dashed=True)
    d.text(46, 314, "candidates", role="blue")
    d.line((160, 308), (184, 308), role="green", width=2)
    d.text(192, 314, "shadow ray to the chosen one", role="green")


def weights(d):
    d.text(330, 36, "weights: p̂ / density", role="faint")
    y = 58
    for i, w in enumerate(WEIGHTS):
        role = "green" if i == CHOSEN else "blue"
        d.rectangle(330, y, 150 * w, 18, role=role, fill=(role, 0.3))
        d.text(320, y + 15, str(i + 1), anchor="end", style="bold")
        y += 30
    d.arrow((400, y + 4), (400, y + 30), role="orange", width=2)
    d.box(330, y + 34, 290, 44, "reservoir: point 2, W = sum / p̂", role="orange", fill=("orange", 0.12))


def draw():
    d = Drawing(640, 330, "Resampling: one of several sampled lights is chosen by its weight, stored with the sum of the weights, and gets a shadow ray")
    scene(d)
    weights(d)
    return d
