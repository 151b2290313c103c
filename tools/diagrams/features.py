"""Filters see through mirrors: the features are those of the reflected surface, placed on the camera ray at the length of the
path. Rough reflections blur the image, so their features lie nearer to the reflecting surface."""

from draw import Drawing

MIRROR_X = 320
HIT = (MIRROR_X, 150)
OBJECT = (150, 84)
IMAGE = (2 * MIRROR_X - OBJECT[0], OBJECT[1])


def draw():
    d = Drawing(630, 310, "Features: behind a mirror, the position along the camera ray at the length of the path, with the mirrored normal")
    camera = (50, 255)
    d.line((MIRROR_X, 40), (MIRROR_X, 262), width=3)
    d.text(MIRROR_X, 28, "reflecting surface", anchor="middle")
    d.line(camera, HIT, OBJECT, role="blue", width=2)
    d.line(HIT, IMAGE, role="orange", width=2, dashed=True)
    d.camera(*camera, angle=-21)
    d.text(24, 290, "camera")
    d.polygon((112, 62), (150, 40), (150, 124), (112, 124), fill=("ink", 0.12))
    d.arrow(OBJECT, (200, 84), width=2)
    d.text(64, 146, "surface")
    d.text(238, 98, "d", role="blue", anchor="middle")
    d.polygon(*[(2 * MIRROR_X - x, y) for x, y in ((112, 62), (150, 40), (150, 124), (112, 124))], role="orange", fill=("orange", 0.12), dashed=True)
    d.arrow(IMAGE, (440, 84), role="orange", width=2)
    d.dot(*IMAGE, role="orange")
    d.dot(*HIT, role="orange")
    d.text(402, 98, "d′", role="orange", anchor="middle")
    d.text(512, 146, "its image", role="orange", anchor="middle")
    d.text(MIRROR_X + 14, 184, "s = 0: blurred reflection", role="orange")
    d.text(500, 30, "s = 1: sharp", role="orange", anchor="middle")
    d.text(MIRROR_X + 14, 230, "features at distance s · d′", role="green")
    d.text(MIRROR_X + 14, 252, "behind the reflecting surface", role="green")
    return d
