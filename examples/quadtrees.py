#!/usr/bin/env python3
"""Draws the directions that path guiding has learned at one pixel's surface, as quadtrees.png.

The image is the octahedral map of the sphere: brighter cells are sampled more often.
"""

from typing import Any

import numpy as np
import relume
from numpy.typing import NDArray


def density(leaves: NDArray[Any], size: int) -> NDArray[Any]:
    """Probability per unit area of the map. All leaves of a tree have the same probability."""
    image = np.zeros((size, size), np.float32)
    for corner, edge in zip(leaves["corner"], leaves["edge"]):
        x, y = (corner * size).astype(int)
        width = max(1, round(float(edge) * size))
        image[y : y + width, x : x + width] = 1 / (len(leaves) * float(edge) ** 2)
    return image


def main() -> None:
    session = relume.Session(relume.builtin("corridor"), 160, 90, preset=None, guide="cdq", history="none")
    session.render(64)
    region = session.buffer("region")[45, 80]
    quadtrees = session.records("cdq.leaves")
    leaves = quadtrees[quadtrees["region"] == int(region)]
    octree = session.records("octree.leaves")
    place = octree[octree["region"] == int(region)][0]
    print(f"the region at {np.round(place['corner'], 2)} has an edge of {place['edge']:.2f} m and {len(leaves)} leaves")
    print(f"the smallest leaf is 1/{round(1 / float(leaves['edge'].min()))} of the map wide")
    image = density(leaves, 256)
    relume.write_image("quadtrees.png", relume.tone_map(np.repeat(image[..., None], 3, axis=2) / 4, "reinhard"))


if __name__ == "__main__":
    main()
