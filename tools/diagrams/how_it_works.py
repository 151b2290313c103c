"""One frame of relume: its stages from top to bottom, and beside them the samples that other frames, paths and pixels reuse."""

from draw import Drawing

LEFT, WIDTH = 150, 268
RIGHT = LEFT + WIDTH
TOP, ROW, HEIGHT = 34, 78, 60
ICON = 56

PREPARE, HITS, HISTORY, ALLOCATE, TRACE, RESOLVE, PRESENT, DENOISE = range(8)
STAGES = (
    ("prepare", "light BVH, guiding"),
    ("hits, G-buffer", "rays to first surfaces"),
    ("history", "reproject old pixels"),
    ("allocate", "0 or 1 path per pixel"),
    ("trace", "paths, shadow rays"),
    ("resolve", "add means of cells"),
    ("present", "merge with history"),
    ("denoise", "filter the noise left"),
)


def middle(row):
    return TOP + ROW * row + HEIGHT / 2


def icon_tree(d, x, y):
    for x0, y0, x1, y1 in ((0, -18, -16, 0), (0, -18, 16, 0), (-16, 0, -24, 18), (-16, 0, -8, 18), (16, 0, 8, 18), (16, 0, 24, 18)):
        d.line((x + x0, y + y0), (x + x1, y + y1), role="orange")
    for dx, dy in ((0, -18), (-16, 0), (16, 0), (-24, 18), (-8, 18), (8, 18), (24, 18)):
        d.dot(x + dx, y + dy, role="orange", radius=3.5)


def icon_hits(d, x, y):
    eye = (x - 24, y)
    d.line((x + 10, y - 20), (x + 22, y - 20), (x + 22, y + 20), (x + 2, y + 20), width=2)
    for end in ((x + 22, y - 12), (x + 22, y + 4), (x + 16, y + 20)):
        d.line(eye, end, role="blue")
        d.dot(*end, role="blue", radius=3)
    d.camera(*eye, size=8)


def cells(d, x, y, size, filled, role):
    """Four by three pixels, of which `filled` are marked."""
    for i in range(12):
        fill = (role, 0.45) if i in filled else None
        d.rectangle(x + size * (i % 4), y + size * (i // 4), size, size, role="faint", fill=fill, stroke=1)


def icon_history(d, x, y):
    cells(d, x - 27, y - 21, 9, {5}, "orange")
    cells(d, x - 7, y - 5, 9, {6}, "orange")
    d.arrow((x - 13, y - 8), (x + 13, y + 7), role="orange", width=2)


def icon_allocate(d, x, y):
    cells(d, x - 24, y - 18, 12, {1, 2, 6, 7, 11}, "blue")


def icon_trace(d, x, y):
    d.rectangle(x + 6, y - 24, 16, 5, fill=("ink", 0.15))
    d.line((x - 26, y + 22), (x + 26, y + 22), width=2)
    path = ((x - 27, y - 10), (x - 12, y + 22), (x + 26, y - 4))
    d.line((x + 26, y + 22), (x + 26, y - 14), width=2)
    d.line(*path, role="blue")
    for vertex, light in ((path[1], (x + 10, y - 19)), (path[2], (x + 18, y - 19))):
        d.line(vertex, light, role="blue", dashed=True, width=1.2)
        d.dot(*vertex, role="blue", radius=3)


def icon_resolve(d, x, y):
    d.line((x - 27, y + 12), (x + 27, y + 12), width=2)
    for i in range(3):
        fill = ("orange", 0.35) if i == 1 else None
        d.rectangle(x - 27 + 18 * i, y + 3, 18, 18, role="orange" if fill else "faint", fill=fill, dashed=not fill, stroke=1.2)
    for dx in (-5, 0, 5):
        d.line((x + 3 * dx, y - 20), (x + dx, y + 12), role="blue")
        d.dot(x + dx, y + 12, role="blue", radius=2.5)


def icon_present(d, x, y):
    for i in range(3):
        d.rectangle(x - 26 + 5 * i, y - 14 + 5 * i, 20, 20, role="orange", fill=("orange", 0.14))
    d.arrow((x + 24, y - 4), (x + 6, y - 4), role="blue", width=2)


def icon_denoise(d, x, y):
    noisy = (-14, -4, -18, -8, -16, 10, 18, 6, 14, 8)
    d.line(*((x - 27 + 6 * i, y + dy) for i, dy in enumerate(noisy)), role="faint", width=1.2)
    d.line((x - 27, y - 12), (x - 3, y - 12), (x + 1, y + 12), (x + 27, y + 12), role="green", width=2.5)


ICONS = (icon_tree, icon_hits, icon_history, icon_allocate, icon_trace, icon_resolve, icon_present, icon_denoise)


def store(d, x, y, width, height, title, *lines):
    d.rectangle(x, y, width, height, role="orange", fill=("orange", 0.14), round=6)
    d.text(x + width / 2, y + 23, title, role="orange", anchor="middle", style="bold")
    for i, line in enumerate(lines):
        d.text(x + width / 2, y + 45 + 20 * i, line, anchor="middle")


def reuse(d, x, y, what):
    d.text(x, y, "reuse across", role="orange")
    d.text(x, y + 20, what, role="orange", style="bold")


def draw():
    d = Drawing(640, TOP + ROW * 8 + 44, "One frame: stages from top to bottom, and the samples that other frames, paths and pixels reuse")
    d.text(LEFT + WIDTH / 2, 20, "scene, camera, settings", anchor="middle")
    for row, ((name, does), icon) in enumerate(zip(STAGES, ICONS)):
        y = TOP + ROW * row
        d.rectangle(LEFT, y, WIDTH, HEIGHT, round=6)
        icon(d, LEFT + 10 + ICON / 2, y + HEIGHT / 2)
        d.text(LEFT + ICON + 26, y + 25, name, style="bold")
        d.text(LEFT + ICON + 26, y + 46, does)
        if row < DENOISE:
            d.arrow((LEFT + WIDTH / 2, y + HEIGHT), (LEFT + WIDTH / 2, y + ROW))
    bottom = TOP + ROW * DENOISE + HEIGHT
    d.arrow((LEFT + WIDTH / 2, bottom), (LEFT + WIDTH / 2, bottom + 22), role="green")
    d.text(LEFT + WIDTH / 2, bottom + 42, "tone-mapped image", role="green", anchor="middle", style="bold")

    # The history, on the left: from present, to history and allocate of the next frame.
    box = (4, middle(TRACE) - 62, 116, 78)
    store(d, *box, "history", "mean and", "variance")
    x = box[0] + box[2] / 2
    d.arrow((LEFT, middle(PRESENT)), (x, middle(PRESENT)), (x, box[1] + box[3]), role="orange", width=2)
    d.line((x, box[1]), (x, middle(HISTORY)), role="orange", width=2)
    d.arrow((x, middle(HISTORY)), (LEFT, middle(HISTORY)), role="orange", width=2)
    d.arrow((x, middle(ALLOCATE) - 8), (LEFT, middle(ALLOCATE) - 8), role="orange", width=2)
    reuse(d, 4, middle(HISTORY) - 34, "frames")

    # Regions, cells and neighbouring pixels, on the right.
    x0, width = RIGHT + 40, 176
    regions = (x0, middle(HITS) - 2, width, 80)
    store(d, *regions, "octree regions", "visible lights,", "light directions")
    x = x0 + width - 34
    d.arrow((RIGHT, middle(TRACE) - 14), (x, middle(TRACE) - 14), (x, regions[1] + regions[3]), role="orange", width=2)
    d.arrow((x, regions[1]), (x, middle(PREPARE)), (RIGHT, middle(PREPARE)), role="orange", width=2)
    reuse(d, x0 + 8, middle(ALLOCATE) - 12, "paths, frames")

    grid = (x0, middle(TRACE) + 42, width, 62)
    store(d, *grid, "radiance cache", "cells of a hash grid")
    d.arrow((RIGHT, middle(TRACE) + 14), (x, middle(TRACE) + 14), (x, grid[1]), role="orange", width=2)
    d.arrow((x0, middle(RESOLVE)), (RIGHT, middle(RESOLVE)), role="orange", width=2)
    reuse(d, x0 + 8, grid[1] + grid[3] + 24, "pixels, frames")

    d.arrow((x0, middle(DENOISE)), (RIGHT, middle(DENOISE)), role="orange", width=2)
    reuse(d, x0 + 8, middle(DENOISE) - 4, "pixels, frames")
    return d
