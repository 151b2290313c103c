"""Camera motion by mouse: orbit, pan and dolly around a pivot."""

import math

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import CameraPose
from ._session import Session


def pivot_distance(session: Session) -> float:
    """Distance from the camera to the surface in the middle of the image, metres; 1 if there is none."""
    depth = session.aov("depth") if "depth" in session.aovs else np.zeros((1, 1), np.float32)
    seen = depth[depth.shape[0] // 2, depth.shape[1] // 2]
    return float(seen) if 0 < seen < 1e6 else 1.0


def orbit(pose: CameraPose, distance: float, right_rad: float, up_rad: float) -> CameraPose:
    """Turns the camera around the point at `distance` before it: about +Y, and about its own horizontal axis."""
    matrix = np.array(pose.to_world, np.float64)
    pivot = matrix[:3, 3] - distance * matrix[:3, 2]
    elevation = math.asin(max(-1.0, min(1.0, matrix[1, 2])))
    limit = math.radians(89)
    up_rad = max(-limit, min(limit, elevation + up_rad)) - elevation
    turned = _rotation((0, 1, 0), right_rad) @ _rotation(matrix[:3, 0], -up_rad) @ matrix[:3, :3]
    moved = matrix.copy()
    moved[:3, :3] = turned
    moved[:3, 3] = pivot + distance * turned[:, 2]
    return CameraPose(camera=pose.camera, to_world=moved)


def pan(pose: CameraPose, right: float, up: float) -> CameraPose:
    """Moves the camera in its image plane, metres."""
    matrix = np.array(pose.to_world, np.float64)
    matrix[:3, 3] += right * matrix[:3, 0] + up * matrix[:3, 1]
    return CameraPose(camera=pose.camera, to_world=matrix)


def dolly(pose: CameraPose, distance: float, factor: float) -> CameraPose:
    """Moves the camera towards the point at `distance` before it, so that the distance changes by `factor`."""
    matrix = np.array(pose.to_world, np.float64)
    matrix[:3, 3] += (factor - 1) * distance * matrix[:3, 2]
    return CameraPose(camera=pose.camera, to_world=matrix)


def _rotation(axis: ArrayLike, angle_rad: float) -> NDArray[Any]:
    """Rotation matrix about a unit axis (Rodrigues' formula)."""
    x, y, z = np.asarray(axis, np.float64)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation: NDArray[Any] = np.eye(3) + math.sin(angle_rad) * cross + (1 - math.cos(angle_rad)) * (cross @ cross)
    return rotation
