"""A pixel repeats the reflection of another pixel's path, and then connects to the vertex that both share."""

from draw import Drawing


def draw():
    d = Drawing(640, 340, "ReSTIR PT: another pixel repeats a path by its random numbers up to the vertex before the joint, and connects to the joint, which it keeps with everything after it")
    d.line((40, 270), (330, 270), role="ink", width=2)
    d.line((250, 50), (420, 50), role="ink", width=2)
    d.line((420, 270), (610, 270), role="ink", width=2)
    d.text(40, 296, "a mirror, seen by the camera")
    d.text(250, 36, "a matte ceiling")
    first, other = (110, 270), (190, 270)
    vertex, repeated, joint, light = (290, 50), (370, 50), (500, 270), (590, 120)
    d.arrow(first, vertex, role="blue", width=2)
    d.arrow(vertex, joint, role="blue", width=2)
    d.arrow(other, repeated, role="orange", width=2, dashed=True)
    d.arrow(repeated, joint, role="orange", width=2)
    d.arrow(joint, light, role="green", width=2)
    for point, role in ((first, "blue"), (other, "orange"), (vertex, "blue"), (repeated, "orange"), (joint, "green")):
        d.dot(*point, role=role, radius=5)
    d.text(98, 256, "x₀", role="blue", anchor="end")
    d.text(180, 256, "y₀", role="orange", anchor="end")
    d.text(282, 76, "x₁", role="blue", anchor="end")
    d.text(384, 76, "y₁", role="orange")
    d.text(500, 296, "joint x₂", role="green", anchor="middle")
    d.text(592, 110, "light", role="green", anchor="middle")
    d.text(112, 180, "sampled", role="blue", anchor="end")
    d.text(258, 214, "replayed", role="orange")
    d.text(436, 130, "reconnected", role="orange")
    d.text(560, 210, "kept", role="green")
    d.text(330, 326, "J = p(y₁→x₂) G(y₁, x₂) p(x₂→light) / the same product from x₁", anchor="middle")
    return d
