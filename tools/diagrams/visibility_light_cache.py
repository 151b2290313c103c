"""A region of the octree lists the lights that shadow rays of one frame reached; the next frame samples this list."""

from draw import Drawing

FLOOR = 200
RIGHT = 352
LIGHTS = ((60, 66), (126, 66), (250, 66))


def room(d, left):
    """A floor, a wall, three lights and a region of the octree."""
    d.line((left, FLOOR), (left + 280, FLOOR), width=2)
    d.rectangle(left + 176, 96, 14, FLOOR - 96, fill=("ink", 0.15))
    d.rectangle(left + 52, FLOOR - 38, 76, 76, role="orange", fill=("orange", 0.16))
    for i, (x, y) in enumerate(LIGHTS):
        d.circle(left + x, y, 8, fill=("ink", 0.12))
        d.text(left + x, y - 16, str(i + 1), anchor="middle")


def draw():
    d = Drawing(640, 310, "A region lists the lights that shadow rays of frame n reached; frame n + 1 chooses among them")
    d.text(8, 20, "frame n: shadow rays", style="bold")
    d.text(RIGHT, 20, "frame n + 1: choice", style="bold")
    room(d, 8)
    for x, light in ((70, 0), (96, 1), (84, 0)):
        d.arrow((8 + x, FLOOR), (8 + LIGHTS[light][0], LIGHTS[light][1] + 10), role="blue")
        d.dot(8 + x, FLOOR, role="blue")
    d.line((8 + 112, FLOOR), (8 + 175, 139), role="blue", dashed=True)
    d.dot(8 + 112, FLOOR, role="blue")
    d.line((178, 130), (190, 142), role="blue", width=2.5)
    d.line((178, 142), (190, 130), role="blue", width=2.5)
    room(d, RIGHT)
    x = RIGHT + 90
    d.arrow((x, FLOOR), (RIGHT + 63, 78), role="green", width=4, head=12)
    d.arrow((x, FLOOR), (RIGHT + 122, 77), role="green", width=2)
    d.arrow((x, FLOOR), (RIGHT + 243, 74), role="faint", dashed=True)
    d.dot(x, FLOOR)
    d.text(x, FLOOR + 24, "x", anchor="middle")
    d.text(RIGHT + 64, 130, "w₁", role="green", anchor="end")
    d.text(RIGHT + 124, 122, "w₂", role="green")
    d.text(RIGHT + 226, 122, "ε", role="faint")
    d.arrow((98, 240), (98, 258), role="orange")
    d.text(8, 276, "region's list: 1, 2", role="orange")
    d.arrow((160, 270), (RIGHT - 12, 270), role="orange", width=2.5)
    d.text(RIGHT, 276, "1 − ε: from the list, by w", role="green")
    d.text(RIGHT, 300, "ε: any light", role="faint")
    return d
