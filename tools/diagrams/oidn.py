"""The library filters the accumulated mean, guided by albedo and normals: after each of 15 frames, then at growing intervals."""

import math

from draw import Drawing

LEFT, RIGHT, AXIS = 40, 590, 250


def x_of(frame):
    return LEFT + (RIGHT - LEFT) * math.log2(frame) / 7.1


def filters_at(frame):
    eighth = 1
    while eighth * 16 <= frame:
        eighth *= 2
    return frame % eighth == 0


def draw():
    d = Drawing(624, 318, "Open Image Denoise: filters the mean with albedo and normals, after more and more frames")
    for y, label in ((26, "mean of samples"), (76, "mean albedo"), (126, "mean normal")):
        d.box(20, y, 160, 34, label, role="blue", fill=("blue", 0.1))
        d.arrow((184, y + 17), (252, 76 + 17 + (y - 76) * 0.36), role="blue")
    d.box(256, 50, 130, 86, "trained", "filter", role="orange", fill=("orange", 0.14))
    d.arrow((390, 93), (444, 93), role="green", width=2.5)
    d.box(448, 72, 156, 42, "denoised image", role="green", fill=("green", 0.14))
    d.line((LEFT, AXIS), (RIGHT, AXIS))
    for frame in range(1, 129):
        x = x_of(frame)
        if filters_at(frame):
            d.line((x, AXIS - 26), (x, AXIS), role="orange", width=2)
    for power in range(8):
        x = x_of(1 << power)
        d.line((x, AXIS), (x, AXIS + 6))
        d.text(x, AXIS + 26, str(1 << power), anchor="middle")
    d.text(LEFT, AXIS - 40, "runs of the filter", role="orange")
    d.text((LEFT + RIGHT) / 2, AXIS + 54, "frames since the last change", anchor="middle")
    return d
