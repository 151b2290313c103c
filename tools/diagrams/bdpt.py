"""A camera subpath, a light subpath, and their connections: each combines s light and t camera vertices into one path."""

from draw import Drawing

FLOOR = 230
CEILING = 40


def draw():
    d = Drawing(640, 320, "A subpath from the camera and one from a light, joined by connections of s light and t camera vertices")
    d.line((110, FLOOR), (570, FLOOR), width=2)
    d.line((190, CEILING), (500, CEILING), width=2)
    camera, z2, z3 = (34, 104), (176, FLOOR), (262, CEILING)
    y1, y2, y3 = (588, 96), (482, FLOOR), (388, CEILING)
    for start, end in ((z2, (575, 100)), (z3, y2), (z2, y3), (y3, (52, 100))):
        d.line(start, end, role="green", dashed=True)
    d.arrow(camera, z2, role="blue", width=2.5)
    d.arrow(z2, z3, role="blue", width=2.5)
    d.arrow((580, 106), y2, role="orange", width=2.5)
    d.arrow(y2, y3, role="orange", width=2.5)
    d.camera(*camera, angle=42)
    d.circle(*y1, 13, fill=("ink", 0.15))
    d.text(12, 92, "camera")
    d.text(588, 74, "light", anchor="middle")
    for at in (z2, z3):
        d.dot(*at, role="blue")
    for at in (y2, y3):
        d.dot(*at, role="orange")
    d.text(z2[0], FLOOR + 22, "t = 2", role="blue", anchor="middle")
    d.text(z3[0], CEILING - 12, "t = 3", role="blue", anchor="middle")
    d.text(594, 130, "s = 1", role="orange")
    d.text(y2[0], FLOOR + 22, "s = 2", role="orange", anchor="middle")
    d.text(y3[0], CEILING - 12, "s = 3", role="orange", anchor="middle")
    d.text(140, 66, "splat, t = 1", role="green", anchor="middle")
    for x, role, text in ((14, "blue", "camera subpath"), (186, "orange", "light subpath")):
        d.line((x, 296), (x + 24, 296), role=role, width=2.5)
        d.text(x + 32, 302, text, role=role)
    d.line((344, 296), (372, 296), role="green", dashed=True)
    d.text(378, 302, "connections, weighted by MIS", role="green")
    return d
