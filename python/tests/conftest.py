"""Shared by the tests."""

import pytest
import relume


@pytest.fixture
def cornell():
    """A session of a small Cornell box with the defaults of all techniques."""
    return relume.Session(relume.builtin("cornell"), 32, 24, preset=None, threads=2)


@pytest.fixture(scope="session")
def box():
    """An open box of unequal colours and extents under a lamp, made of arrays."""
    scene = relume.Scene("box")
    red = scene.add_material(base_color=(0.8, 0.1, 0.1), roughness=1)
    white = scene.add_material(base_color=(0.7, 0.7, 0.7), roughness=1)
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    faces = [[0, 1, 2], [0, 2, 3]]
    scene.add_mesh(square, faces, material=red)
    floor = scene.add_mesh([[0, 0, 0], [2, 0, 0], [2, 0, 2], [0, 0, 2]], [[0, 2, 1], [0, 3, 2]], material=white, node=False)
    scene.add_node(meshes=[floor], name="floor")
    scene.add_light("point", (1, 2, 1), intensity=(4, 4, 4))
    scene.add_camera(eye=(1, 1, 4), target=(1, 0.5, 0), fov_degrees=40)
    scene.environment.kind = "none"
    return scene
