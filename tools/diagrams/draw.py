"""Line drawings as SVG, with one palette for light and dark pages. Coordinates are in pixels, y points down.

A page shows a drawing at its own width, or narrower: at 400 pixels its text must still be legible, so drawings are at
most 640 wide. Strokes, fills and text take a role in place of a colour:

    ink    what exists: surfaces, boxes, labels       blue    the paths or samples at hand
    faint  context, guides, dimensions                orange  what is stored or reused
                                                      green   the result
"""

import math
from xml.sax.saxutils import escape

LIGHT = {"ink": "#1f2328", "faint": "#6e7781", "blue": "#0969da", "orange": "#bc4c00", "green": "#1a7f37", "page": "#ffffff"}
DARK = {"ink": "#e6edf3", "faint": "#8b949e", "blue": "#58a6ff", "orange": "#f0883e", "green": "#3fb950", "page": "#0d1117"}
FONT = "system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', sans-serif"
MAX_WIDTH = 640
TEXT_SIZE = 16


def _number(x):
    return f"{x:.1f}".rstrip("0").rstrip(".")


def _points(points):
    return " ".join(f"{_number(x)},{_number(y)}" for x, y in points)


def _style():
    def rules(colors):
        return "".join(
            f".s-{role}{{stroke:{color}}}.f-{role}{{fill:{color}}}" for role, color in colors.items()) + f".halo{{stroke:{colors['page']}}}"

    return (f"text{{font:{TEXT_SIZE}px {FONT}}}.small{{font-size:13px}}.code{{font-family:ui-monospace,'DejaVu Sans Mono',monospace;font-size:14px}}"
            f".italic{{font-style:italic}}.bold{{font-weight:600}}"
            f".halo{{paint-order:stroke;stroke-width:4px;stroke-linejoin:round}}"
            f"{rules(LIGHT)}@media(prefers-color-scheme:dark){{{rules(DARK)}}}")


class Drawing:
    """Shapes in the order in which they cover each other."""

    def __init__(self, width, height, title):
        assert width <= MAX_WIDTH, f"{title}: {width} pixels are too wide; at most {MAX_WIDTH}"
        self.width = width
        self.height = height
        self.title = title
        self.shapes = []

    def _add(self, tag, role, fill, width, dashed, attributes):
        stroke = f' class="s-{role}" fill="none"' if fill is None else f' class="s-{role} f-{fill[0]}" fill-opacity="{fill[1]}"'
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        self.shapes.append(f'<{tag} {attributes}{stroke} stroke-width="{_number(width)}"{dash}/>')

    def line(self, *points, role="ink", width=1.5, dashed=False):
        self._add("polyline", role, None, width, dashed, f'points="{_points(points)}" stroke-linejoin="round" stroke-linecap="round"')

    def arrow(self, *points, role="ink", width=1.5, dashed=False, head=8):
        """A line with a head at its last point."""
        (x0, y0), (x1, y1) = points[-2], points[-1]
        angle = math.atan2(y1 - y0, x1 - x0)
        side = [(x1 - head * math.cos(angle + turn), y1 - head * math.sin(angle + turn)) for turn in (0.42, -0.42)]
        neck = (x1 - 0.8 * head * math.cos(angle), y1 - 0.8 * head * math.sin(angle))
        self.line(*points[:-1], neck, role=role, width=width, dashed=dashed)
        self.shapes.append(f'<polygon points="{_points([(x1, y1), *side])}" class="f-{role}"/>')

    def step(self, x0, x1, y, label, role="ink"):
        """A horizontal arrow from one state to the next, with its label above."""
        self.arrow((x0, y), (x1, y), role=role, width=2)
        self.text((x0 + x1) / 2, y - 12, label, role=role, anchor="middle")

    def curve(self, start, control, end, role="ink", width=1.5, dashed=False):
        """A quadratic Bézier curve."""
        path = f"M{_points([start])} Q{_points([control])} {_points([end])}"
        self._add("path", role, None, width, dashed, f'd="{path}"')

    def polygon(self, *points, role="ink", fill=None, width=1.5, dashed=False):
        """`fill`: a role and its opacity."""
        self._add("polygon", role, fill, width, dashed, f'points="{_points(points)}" stroke-linejoin="round"')

    def rectangle(self, x, y, width, height, role="ink", fill=None, stroke=1.5, dashed=False, round=0):
        attributes = f'x="{_number(x)}" y="{_number(y)}" width="{_number(width)}" height="{_number(height)}" rx="{round}"'
        self._add("rect", role, fill, stroke, dashed, attributes)

    def circle(self, x, y, radius, role="ink", fill=None, width=1.5, dashed=False):
        self._add("circle", role, fill, width, dashed, f'cx="{_number(x)}" cy="{_number(y)}" r="{_number(radius)}"')

    def dot(self, x, y, role="ink", radius=4):
        self.shapes.append(f'<circle cx="{_number(x)}" cy="{_number(y)}" r="{_number(radius)}" class="f-{role}"/>')

    def text(self, x, y, text, role="ink", anchor="start", style=""):
        """`y`: of the baseline. `anchor`: start, middle, end. `style`: of small, code, italic, bold."""
        classes = f"f-{role} halo {style}".strip()
        self.shapes.append(f'<text x="{_number(x)}" y="{_number(y)}" text-anchor="{anchor}" class="{classes}">{escape(text)}</text>')

    def box(self, x, y, width, height, *lines, role="ink", fill=None, style=""):
        """A rounded rectangle with centred lines of text."""
        self.rectangle(x, y, width, height, role=role, fill=fill, round=6)
        first = y + height / 2 + 5.5 - 10 * (len(lines) - 1)
        for i, line in enumerate(lines):
            self.text(x + width / 2, first + 20 * i, line, anchor="middle", style=style)

    def camera(self, x, y, angle=0, role="ink", size=14):
        """An eye point with its field of view, which looks along `angle` degrees, clockwise from +x."""
        sides = [(x + size * 1.6 * math.cos(math.radians(angle + s)), y + size * 1.6 * math.sin(math.radians(angle + s))) for s in (-25, 25)]
        self.polygon((x, y), *sides, role=role, fill=(role, 0.12))

    def svg(self):
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" height="{self.height}" '
                f'viewBox="0 0 {self.width} {self.height}" role="img">')
        return "\n".join([head, f"<title>{escape(self.title)}</title>", f"<style>{_style()}</style>", *self.shapes, "</svg>", ""])
