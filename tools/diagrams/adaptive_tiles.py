"""Pixels of a tile report lights in one frame; the sorted list of the tile serves the choice in the next."""

from draw import Drawing

CELL = 22
LEFT = 14
TOP = 62
LIGHTS = ("2", "2", "–", "5", "2", "5", "2", "–", "2", "2", "5", "2", "2", "–", "2", "5")
LIST = ("2", "2", "2", "2", "2", "2", "2", "2", "2", "5", "5", "5", "5", "5", "7")


def draw():
    d = Drawing(640, 300, "Pixels of frame n report the lights that reached them; the lists of tiles in frame n + 1 hold these")
    d.text(LEFT, 22, "frame n: the light of each pixel", style="bold")
    d.text(360, 22, "frame n + 1: choice at x", style="bold")
    for row in range(8):
        for column in range(8):
            d.rectangle(LEFT + CELL * column, TOP + CELL * row, CELL, CELL, role="faint", stroke=0.6)
    d.rectangle(LEFT + 2 * CELL, TOP + 2 * CELL, 4 * CELL, 4 * CELL, role="orange", fill=("orange", 0.16), stroke=2)
    for i, light in enumerate(LIGHTS):
        x = LEFT + CELL * (2 + i % 4) + CELL / 2
        d.text(x, TOP + CELL * (2 + i // 4) + 17, light, role="blue" if light != "–" else "faint", anchor="middle")
    d.text(LEFT + 7.5 * CELL, TOP + 3 * CELL - 5, "7", role="blue", anchor="middle")
    d.text(LEFT + 8.3 * CELL, TOP + 3.5 * CELL, "tile", role="orange")
    d.text(LEFT, 258, "–: replaced by an entry of the old list", role="faint", style="small")
    d.arrow((LEFT + 8 * CELL + 4, TOP + 5 * CELL), (352, 96), role="orange", width=2)
    width = 18
    for i, light in enumerate(LIST):
        d.rectangle(360 + width * i, 84, width, 26, role="orange", fill=("orange", 0.16), stroke=1)
        d.text(360 + width * (i + 0.5), 103, light, anchor="middle")
    d.text(360, 66, "sorted list of the tile", role="orange")
    d.arrow((420, 178), (420, 116), role="green", width=3.5)
    d.text(432, 152, "0.65: an entry", role="green")
    d.dot(420, 184)
    d.text(402, 190, "x", anchor="end")
    d.arrow((420, 190), (420, 236), role="faint", dashed=True)
    d.text(432, 220, "0.35: any light, by its", role="faint")
    d.text(432, 240, "power and its use", role="faint")
    d.text(360, 280, "P(2) = 0.65 · 9/15 + 0.35 · p(2)", role="green", style="small")
    return d
