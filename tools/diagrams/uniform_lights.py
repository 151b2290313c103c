"""One random number selects a light; its rescaled remainder selects a point on that light."""

from draw import Drawing

U = 0.66


def axis(d, y, name, left, width, role="ink"):
    d.line((left, y), (left + width, y), role=role, width=2)
    for x in (left, left + width):
        d.line((x, y - 6), (x, y + 6), role=role, width=2)
    d.text(left - 8, y + 6, name, role=role, anchor="end", style="italic")


def draw():
    d = Drawing(640, 250, "One random number u chooses light 2 of lights 0 to 3, and its rest a point on that light")
    left, right = 60, 620
    width = (right - left) / 4
    axis(d, 90, "u", left, right - left)
    for i in range(4):
        x = left + width * i
        chosen = i == 2
        role = "green" if chosen else "faint"
        d.circle(x + width / 2, 30, 13, role=role, fill=(role, 0.25 if chosen else 0.1))
        d.text(x + width / 2, 36, str(i), role=role, anchor="middle", style="bold")
        if i:
            d.line((x, 82), (x, 98), width=2)
        d.text(x + width / 2, 74, "1/4", role=role, anchor="middle")
    at = left + U * (right - left)
    d.dot(at, 90, role="blue", radius=5)
    low, high = left + 2 * width, left + 3 * width
    d.line((low, 98), (left, 178), role="faint", dashed=True)
    d.line((high, 98), (right, 178), role="faint", dashed=True)
    axis(d, 190, "u′", left, right - left, role="green")
    rest = left + (4 * U - 2) * (right - left)
    d.arrow((at, 96), (rest, 182), role="blue")
    d.dot(rest, 190, role="blue", radius=5)
    d.text(left, 230, "u′ = n u − i places the point on light i", role="green")
    return d
