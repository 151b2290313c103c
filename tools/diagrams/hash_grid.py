"""Cells grow with the distance from the camera. A hash of cell and level gives the slots to probe, and a fingerprint identifies
the cell. A slot holds the sums of this frame, which paths add to, and the moments of earlier frames, which they read."""

from draw import Drawing

FLOOR = 122
CELLS = ((150, 30), (180, 30), (210, 30), (240, 60), (300, 60), (360, 60), (420, 120))
OWN = 4
ROW = 240
SLOT = 44
TAKEN = (0, 2, 3, 4, 5, 8)
FIRST = 3
FOUND = 5


def slot_x(i):
    return 90 + SLOT * i


def draw():
    d = Drawing(620, 400, "Hash grid: cells grow with distance; a hash of a cell chooses its slot, which holds sums of this frame and moments of earlier ones")
    camera = (40, 44)
    for x, edge in CELLS:
        d.rectangle(x, FLOOR - edge / 2, edge, edge, role="faint", dashed=True)
    x, edge = CELLS[OWN]
    d.rectangle(x, FLOOR - edge / 2, edge, edge, role="orange", fill=("orange", 0.16))
    d.line((130, FLOOR), (600, FLOOR), width=2)
    d.line(camera, (400, FLOOR), role="blue")
    d.arrow((400, FLOOR), (336, FLOOR), role="orange", width=2.5)
    d.dot(400, FLOOR, role="blue")
    d.camera(*camera, angle=18)
    d.text(24, 28, "camera")
    d.text(404, FLOOR - 8, "x", role="blue")
    d.text(388, FLOOR + 20, "jitter", role="orange", anchor="middle")
    d.text(330, 30, "cells cover 8 pixels at any distance", role="faint", anchor="middle")
    d.text(195, FLOOR + 36, "level l − 1", role="faint", anchor="middle")
    d.text(270, FLOOR + 50, "level l", role="faint", anchor="middle")
    d.text(480, FLOOR + 26, "level l + 1", role="faint", anchor="middle")

    d.text(24, ROW + 26, "table")
    for i in range(11):
        own = i == FOUND
        fill = ("orange", 0.16) if own else ("ink", 0.12) if i in TAKEN else None
        d.rectangle(slot_x(i), ROW, SLOT, 40, role="orange" if own else "ink", fill=fill)
    first = slot_x(FIRST) + SLOT / 2
    d.arrow((330, 152), (330, 200), (first, 200), (first, ROW - 2), role="orange")
    d.text(346, 208, "hash(cell, level, layer)", role="orange")
    for i in range(FIRST, FOUND):
        x = slot_x(i) + SLOT / 2
        d.arrow((x + 4, ROW + 20), (x + SLOT - 6, ROW + 20), role="blue")
    d.text(24, 314, "probe until the fingerprint", role="blue")
    d.text(24, 334, "matches", role="blue")
    left, right = slot_x(FOUND), slot_x(FOUND + 1)
    d.line((left, ROW + 40), (270, 300), role="orange", dashed=True)
    d.line((right, ROW + 40), (600, 300), role="orange", dashed=True)
    d.box(270, 300, 156, 60, "sums of", "this frame", role="blue", fill=("blue", 0.1))
    d.box(444, 300, 156, 60, "moments of", "earlier frames", role="orange", fill=("orange", 0.16))
    d.text(348, 382, "paths add", role="blue", anchor="middle")
    d.text(522, 382, "paths read", role="orange", anchor="middle")
    return d
