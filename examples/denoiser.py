#!/usr/bin/env python3
"""A denoiser of one's own, in NumPy: a cross-bilateral filter of irradiance, called after the samples are accumulated."""

from typing import Any

import numpy as np
import relume
from numpy.typing import NDArray

RADIUS = 3
SIZE = (96, 54)


def shifted(array: NDArray[Any], dx: int, dy: int) -> NDArray[Any]:
    """The array moved by (dx, dy) pixels; edges repeat."""
    height, width = array.shape[:2]
    rows = np.clip(np.arange(height) + dy, 0, height - 1)
    columns = np.clip(np.arange(width) + dx, 0, width - 1)
    return array[rows][:, columns]


def denoise(session: relume.Session) -> None:
    """Divides by the albedo, averages pixels with similar normals and depths, and multiplies again."""
    mean, albedo = session.buffer("mean"), session.aov("albedo")
    normal, depth = session.aov("normal"), session.aov("depth")
    reflects = albedo.max(2) > 0.02  # black surfaces keep their value
    irradiance = mean / np.maximum(albedo, 0.02)
    total, weights = np.zeros_like(irradiance), np.zeros(depth.shape, np.float32)
    for dy in range(-RADIUS, RADIUS + 1):
        for dx in range(-RADIUS, RADIUS + 1):
            facing = np.clip((normal * shifted(normal, dx, dy)).sum(2), 0, 1) ** 32
            near = np.exp(-np.abs(depth - shifted(depth, dx, dy)) / (0.02 * depth + 1e-6))
            weight = shifted(reflects, dx, dy) * facing * near * np.exp(-(dx * dx + dy * dy) / (RADIUS * RADIUS))
            total += weight[..., None] * shifted(irradiance, dx, dy)
            weights += weight
    filtered = albedo * total / np.maximum(weights, 1e-6)[..., None]
    session.replace_image(np.where((reflects & (weights > 0))[..., None], filtered, mean))


def session_of_the_boxes(seed: int) -> relume.Session:
    """The lamp is out of view: a filter of irradiance would spread its emission."""
    session = relume.Session(relume.builtin("cornell"), *SIZE, preset=None, seed=seed)
    view = session.camera
    view.camera.fov_y_rad *= 0.6
    session.set_camera(view)
    return session


def main() -> None:
    reference = session_of_the_boxes(seed=1)
    reference.render(1024)
    session = session_of_the_boxes(seed=0)
    session.render(4)
    print(f"4 samples: MSE {relume.metrics.mse(session.image, reference.image):.5f}")
    session.restart()
    session.after("present", denoise)
    session.render(4)
    print(f"denoised:  MSE {relume.metrics.mse(session.image, reference.image):.5f}")
    relume.write_image("denoised.png", relume.tone_map(session.image))


if __name__ == "__main__":
    main()
