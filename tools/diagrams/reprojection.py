"""Stored samples are validated for the new camera. The histories of valid ones move to the pixels that now show them."""

from draw import Drawing

FLOOR = 190
CELL = 40
LEFT = 116
BEFORE = 268  # top of the rows of pixels
NOW = 346


def cross(d, x, y, role="ink"):
    for s in (-1, 1):
        d.line((x - 6, y - 6 * s), (x + 6, y + 6 * s), role=role, width=2.5)


def middle(cell):
    return LEFT + CELL * (cell + 0.5)


def scene(d):
    before, now = (120, 48), (424, 48)
    d.rectangle(210, 128, 40, FLOOR - 128, fill=("ink", 0.15))
    d.line((40, FLOOR), (600, FLOOR), width=2)
    d.line((490, FLOOR), (590, FLOOR), role="faint", width=5)
    for x in (150, 380, 530):
        d.line(before, (x, FLOOR), role="faint", dashed=True)
    d.arrow((150, FLOOR), (208, 159), role="blue")
    d.arrow((380, FLOOR), (420, 64), role="blue")
    d.arrow((530, FLOOR), (435, 64), role="blue")
    for x in (150, 380, 530):
        d.dot(x, FLOOR, role="orange", radius=5)
    cross(d, 214, 155)
    cross(d, 516, 170)
    d.camera(*before, angle=52, role="faint")
    d.camera(*now, angle=90)
    d.text(24, 28, "camera before", role="faint")
    d.text(444, 44, "camera now")
    d.text(150, FLOOR + 24, "occluded", anchor="middle")
    d.text(380, FLOOR + 24, "kept", role="green", anchor="middle")
    d.text(538, FLOOR + 24, "view dependent", anchor="middle")


def rows(d):
    kept = {3: 2, 4: 3, 5: 4, 6: 5, 7: 7, 8: 8, 9: 9, 11: 11}
    for cell in range(12):
        d.rectangle(LEFT + CELL * cell, BEFORE, CELL, 24, role="faint", fill=("orange", 0.25))
        fill = ("green", 0.3) if cell in kept.values() or cell == 6 else None
        d.rectangle(LEFT + CELL * cell, NOW, CELL, 24, role="faint", fill=fill)
    for source, target in kept.items():
        d.arrow((middle(source), BEFORE + 26), (middle(target), NOW - 2), role="orange")
    for cell in (1, 2, 10):
        cross(d, middle(cell), BEFORE + 12)
    for cell in (6, 7):
        d.arrow((middle(6) + 8 * (cell - 6.5), NOW - 2), (middle(cell) + (9 if cell == 6 else -9), BEFORE + 26), role="blue", dashed=True)
    d.arrow((middle(0), BEFORE + 26), (middle(0) - 38, NOW - 16), role="faint", dashed=True)
    d.text(LEFT - 12, BEFORE + 18, "frame t − 1", anchor="end")
    d.text(LEFT - 12, NOW + 18, "frame t", anchor="end")
    d.text(middle(0.5), NOW + 46, "no history", anchor="middle")
    d.text(middle(6), NOW + 46, "hole: looks back", role="blue", anchor="middle")
    d.text(middle(10), NOW + 46, "no history", anchor="middle")


def draw():
    d = Drawing(620, 404, "Reprojection: stored samples are verified from the new camera, and histories that pass move to its pixels")
    scene(d)
    rows(d)
    return d
