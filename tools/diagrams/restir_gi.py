"""A receiver reconnects to the vertex that another receiver's path has found."""

from draw import Drawing


def draw():
    d = Drawing(632, 330, "ReSTIR GI: the point that one pixel's path has found is connected to the surface of another pixel, and the Jacobian compares their solid angles")
    d.line((60, 250), (572, 250), role="ink", width=2)
    d.line((180, 60), (470, 60), role="ink", width=2)
    d.text(70, 276, "surfaces seen by the camera")
    first, second, vertex = (170, 250), (430, 250), (330, 60)
    d.arrow(first, vertex, role="blue", width=2)
    d.arrow(second, vertex, role="orange", width=2)
    d.arrow(vertex, (330, 122), role="faint")
    d.arrow((420, 140), vertex, role="green", width=2)
    for point, role in ((first, "blue"), (second, "orange"), (vertex, "green")):
        d.dot(*point, role=role, radius=5)
    d.text(150, 232, "x", role="blue")
    d.text(442, 232, "x′", role="orange")
    d.text(318, 42, "y, with the light L that it reflects", role="green", anchor="middle")
    d.text(300, 118, "n", role="ink")
    d.text(430, 136, "light sampled at y,", role="green")
    d.text(430, 158, "further bounces", role="green")
    d.text(120, 150, "d, φ: sampled", role="blue")
    d.text(420, 196, "d′, φ′: reconnected", role="orange")
    d.text(316, 310, "J = (cos φ′ / d′²) / (cos φ / d²)", anchor="middle")
    return d
