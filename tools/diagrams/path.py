"""A path combines two strategies at each vertex: a shadow ray to a sampled light, and a BSDF sample that may hit a light."""

from draw import Drawing

FLOOR = 226


def draw():
    d = Drawing(640, 310, "At each vertex, a shadow ray goes to a sampled light, and the path continues along a sampled direction, which may meet a light")
    d.line((20, FLOOR), (600, FLOOR), width=2)
    d.line((600, 60), (600, FLOOR), width=2)
    d.rectangle(250, 24, 150, 12, fill=("ink", 0.15))
    d.text(240, 36, "light", anchor="end")
    camera, x1, x2 = (30, 86), (176, FLOOR), (600, 150)
    d.arrow(camera, x1, role="blue", width=2)
    d.arrow(x1, x2, role="blue", width=2)
    d.arrow(x2, (384, 40), role="blue", width=2)
    d.arrow(x1, (280, 40), role="green", dashed=True)
    d.arrow(x2, (330, 40), role="green", dashed=True)
    d.camera(*camera, angle=44)
    d.text(12, 74, "camera")
    for x, y in (x1, x2):
        d.dot(x, y)
    d.text(170, FLOOR + 22, "x₁", anchor="middle")
    d.text(612, 156, "x₂")
    d.text(218, 120, "P · p_light", role="green", anchor="end")
    d.text(400, 210, "p_bsdf", role="blue")
    d.text(520, 84, "p_bsdf", role="blue")
    d.line((24, 268), (60, 268), role="green", dashed=True)
    d.text(72, 274, "next event estimation, weight w(P · p_light, p_bsdf)", role="green")
    d.line((24, 292), (60, 292), role="blue", width=2)
    d.text(72, 298, "BSDF sampling; if it meets a light, weight w(p_bsdf, P · p_light)", role="blue")
    return d
