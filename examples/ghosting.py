#!/usr/bin/env python3
"""Measures what histories leave behind a moving camera: the bias of the last frame of a path, with and without one.

The mean over many seeds removes the noise. What remains of the difference from a reference is bias, such as ghosting.
"""

from typing import Any

import numpy as np
import relume
from numpy.typing import NDArray

STEPS = 8
SEEDS = 16
SIZE = (64, 36)


def views() -> list[relume.CameraPose]:
    """A walk past the boxes."""
    return [relume.camera_pose((0.3 * step / STEPS, 1, 3.2), (0, 1, 0), fov_degrees=40) for step in range(STEPS)]


def last_image(scene: relume.Scene, seed: int, settings: dict[str, str]) -> relume.Image:
    session = relume.Session(scene, *SIZE, preset=None, settings={"seed": seed, **settings})
    for view in views():
        session.set_camera(view)
        session.render()
    return session.image


def relative_bias(images: NDArray[Any], reference: NDArray[Any]) -> float:
    """Squared bias over the squared reference, mean over pixels. The mean of n images has 1/n of their variance."""
    squared = (images.mean(0) - reference) ** 2 - images.var(0, ddof=1) / len(images)
    return float((squared / (reference**2 + 0.01)).mean())


def main() -> None:
    scene = relume.builtin("cornell-spheres")
    still = relume.Session(scene, *SIZE, preset=None, seed=1000)
    still.set_camera(views()[-1])
    still.render(2048)
    reference = np.array(still.image)
    histories = {
        "no history": {"history": "none"},
        "backward": {"history": "reproject", "reproject_method": "backward"},
        "forward": {"history": "reproject", "reproject_method": "forward"},
    }
    for name, settings in histories.items():
        images = np.stack([last_image(scene, seed, settings) for seed in range(SEEDS)])
        error = float(np.mean([relume.metrics.rel_mse(image, reference) for image in images]))
        print(f"{name}: relative MSE of a frame {error:.4f}, of which bias {relative_bias(images, reference):.4f}")


if __name__ == "__main__":
    main()
