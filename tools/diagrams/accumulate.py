"""The samples of one pixel scatter; their mean converges, and its standard error shrinks. A change restarts both."""

import math

from draw import Drawing

SAMPLES = (0.9, 0.12, 0.55, 0.2, 0.75, 0.3, 0.05, 0.62, 0.4, 0.85, 0.28, 0.48, 0.15, 0.66, 0.35, 0.5, 0.22, 0.58, 0.45, 0.32, 0.7, 0.38, 0.25, 0.52)
AFTER = (0.95, 0.45, 0.7, 0.85, 0.55, 0.92, 0.6, 0.8, 0.72)
LEFT, STEP, BASE, HEIGHT = 52, 16, 216, 160


def height(value):
    return BASE - HEIGHT * value


def accumulate(d, first, samples):
    mean = squares = 0.0
    means, band = [], []
    for n, value in enumerate(samples, 1):
        before = mean
        mean += (value - mean) / n
        squares += (value - before) * (value - mean)
        x = LEFT + STEP * (first + n)
        means.append((x, height(mean)))
        if n > 1:
            error = math.sqrt(squares / (n * (n - 1)))
            band.append((x, height(min(mean + error, 1)), height(max(mean - error, 0))))
    upper = [(x, top) for x, top, _ in band]
    lower = [(x, bottom) for x, _, bottom in reversed(band)]
    d.polygon(*upper, *lower, role="orange", fill=("orange", 0.2), width=1)
    for n, value in enumerate(samples, 1):
        d.dot(LEFT + STEP * (first + n), height(value), role="blue")
    d.line(*means, role="green", width=3)


def draw():
    d = Drawing(620, 284, "Accumulation: the mean of a pixel's samples settles, its standard error narrows, and a change starts both again")
    d.arrow((LEFT, BASE), (LEFT, 40))
    d.arrow((LEFT, BASE), (604, BASE))
    accumulate(d, 0, SAMPLES)
    change = LEFT + STEP * 24.5
    d.line((change, 40), (change, BASE + 8), dashed=True)
    accumulate(d, 24, AFTER)
    d.text(LEFT - 28, 28, "luminance")
    d.text(change, 28, "a change", anchor="middle")
    d.text(604, BASE + 24, "frames", anchor="end")
    d.text(LEFT, 272, "samples", role="blue")
    d.text(150, 272, "their mean: the image", role="green")
    d.text(354, 272, "± its standard error", role="orange")
    return d
