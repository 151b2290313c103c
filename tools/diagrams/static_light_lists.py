"""Rays traced once from every cell of a grid find the lights visible there; a surface point samples the list of its cell."""

from draw import Drawing

CELL = 66
LEFT = 14
TOP = 60
FLOOR = TOP + 2.5 * CELL
LIGHTS = ((56, 34), (150, 34), (300, 34))


def draw():
    d = Drawing(640, 300, "Once, rays from each cell to random points on the lights find which lights the cell sees; its list serves every later frame")
    for row in range(3):
        for column in range(5):
            d.rectangle(LEFT + CELL * column, TOP + CELL * row, CELL, CELL, role="faint", stroke=0.8)
    d.rectangle(LEFT + CELL, TOP + 2 * CELL, CELL, CELL, role="orange", fill=("orange", 0.2))
    d.line((LEFT, FLOOR), (LEFT + 5 * CELL, FLOOR), width=2)
    d.rectangle(LEFT + 3 * CELL - 6, TOP + 46, 14, FLOOR - TOP - 46, fill=("ink", 0.2))
    for i, (x, y) in enumerate(LIGHTS):
        d.rectangle(x - 16, y - 5, 32, 10, fill=("ink", 0.12))
        d.text(x + 24, y + 6, str(i + 1))
    start = ((92, 206), (116, FLOOR), (136, 212), (104, FLOOR))
    for (x, y), target in zip(start, ((50, 40), (66, 40), (146, 40))):
        d.arrow((x, y), target, role="blue")
        d.dot(x, y, role="blue", radius=3)
    d.line((126, FLOOR), (204, 150), role="blue", dashed=True)
    d.dot(126, FLOOR, role="blue", radius=3)
    for side in (-1, 1):
        d.line((200, 150 - 6 * side), (212, 150 + 6 * side), role="blue", width=2.5)
    d.arrow((LEFT + 2 * CELL, TOP + 2.75 * CELL), (382, TOP + 2.75 * CELL), role="orange", width=2)
    d.text(390, 128, "Before the first frame:", role="blue")
    d.text(390, 150, "≥ 4,096 rays per cell,", role="blue")
    d.text(390, 172, "≥ 64 per light", role="blue")
    d.text(390, TOP + 2.75 * CELL + 6, "List of the cell: 1, 2", role="orange")
    d.text(390, 286, "At a point: from the list, by w", role="green")
    d.text(14, 286, "3 is behind the wall: not on the list")
    return d
