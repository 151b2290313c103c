"""Scenes: lists of meshes, materials, lights, cameras and nodes, from files or NumPy arrays."""

import copy
import math
import os
from collections.abc import Sequence
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._core import (AnimationChannel, Camera, CameraPose, Environment, Light, Material, Mesh, MorphTarget, Node,
                    ParameterChannel, Skin, SunSky, Texture, TextureRef, Transform)
from ._errors import Error
from ._image import Path

Vector = Union[Sequence[float], NDArray[Any]]

__all__ = ["AnimationChannel", "Camera", "CameraPose", "Environment", "Light", "Material", "Mesh", "MorphTarget", "Node",
           "ParameterChannel", "Scene", "Skin", "SunSky", "Texture", "TextureRef", "Transform", "builtin", "builtin_scenes",
           "camera_pose", "load", "load_environment", "look_at"]


class Scene:
    """A scene in metres, right-handed, +Y up, with linear Rec. 709 radiance.

    Its lists hold the objects that sessions copy when they begin: change them freely. References between the parts are
    indices in these lists; the `add` methods return them.
    """

    __slots__ = {
        "name": "For messages.",
        "textures": "List of Texture.",
        "materials": "List of Material.",
        "meshes": "List of Mesh.",
        "lights": "List of Light.",
        "cameras": "List of Camera.",
        "nodes": "List of Node, in any order.",
        "skins": "List of Skin.",
        "animation": "List of AnimationChannel.",
        "parameter_animation": "List of ParameterChannel.",
        "environment": "Light from infinity.",
        "clips": "Names of the animations.",
        "variants": "Names for choose_variant().",
        "visible_sets": "Boxes as (low, high, visible): corners in metres, and indices of the boxes that see each other. "
                        "Empty: unknown.",
        "settings_json": "Settings that the file requests, a JSON object; empty: none. Sessions apply them before the preset.",
        "crop": "Part of the image that the file requests: left, top, right and bottom in fractions of its size. `relume render` "
                "follows it; sessions have their own argument, in pixels.",
        "warnings": "Ignored or repaired input of the file, one sentence each.",
        "notes": "Ignored input without effect on images, one sentence each.",
        "source_files": "Files that were read, including missing ones.",
        "__weakref__": "",
    }

    def __init__(self, name: str = "") -> None:
        self.name = name
        self.textures: list[Texture] = []
        self.materials: list[Material] = []
        self.meshes: list[Mesh] = []
        self.lights: list[Light] = []
        self.cameras: list[Camera] = []
        self.nodes: list[Node] = []
        self.skins: list[Skin] = []
        self.animation: list[AnimationChannel] = []
        self.parameter_animation: list[ParameterChannel] = []
        self.environment = Environment(kind="automatic")
        self.clips: list[str] = []
        self.variants: list[str] = []
        self.visible_sets: list[tuple[Sequence[float], Sequence[float], Sequence[int]]] = []
        self.settings_json = ""
        self.crop: tuple[float, float, float, float] = (0, 0, 1, 1)
        self.warnings: list[str] = []
        self.notes: list[str] = []
        self.source_files: list[str] = []

    def __repr__(self) -> str:
        triangles = sum(len(mesh.triangles) for mesh in self.meshes)
        return (f"<relume.Scene '{self.name}': {len(self.nodes)} nodes, {len(self.meshes)} meshes with {triangles} triangles, "
                f"{len(self.materials)} materials, {len(self.lights)} lights, {len(self.cameras)} cameras>")

    def add_texture(self, texels: Any, **attributes: Any) -> int:
        """Adds a texture from an array of shape (height, width, 3) or (height, width, 4) and returns its index.

        uint8 values are sRGB (or data, with format="rgba8-linear"); others are linear floats.
        """
        texture = Texture(**attributes)
        texture.texels = texels
        self.textures.append(texture)
        return len(self.textures) - 1

    def add_material(self, material: Optional[Material] = None, **attributes: Any) -> int:
        """Adds a material, or one with these attributes, and returns its index."""
        self.materials.append(material if material is not None else Material(**attributes))
        return len(self.materials) - 1

    def add_mesh(self, positions: Any, triangles: Any, *, node: bool = True, **attributes: Any) -> int:
        """Adds a mesh and returns its index.

        `positions` has the shape (n, 3), `triangles` (m, 3). Further attributes are those of Mesh: normals, uv0, colors,
        material. A node without a transform shows the mesh, unless `node` is False.
        """
        self.meshes.append(Mesh(positions=positions, triangles=triangles, **attributes))
        index = len(self.meshes) - 1
        if node:
            self.add_node(meshes=[index])
        return index

    def add_light(self, type: str = "point", position: Vector = (0, 0, 0), target: Optional[Vector] = None,
                  **attributes: Any) -> int:
        """Adds a light at `position` that shines towards `target` (default: downwards) and returns its index."""
        x, y, z = position
        transform = look_at(position, (x, y - 1, z) if target is None else target)
        self.lights.append(Light(type=type, **attributes))
        index = len(self.lights) - 1
        self.add_node(light=index, transform=transform)
        return index

    def add_camera(self, eye: Vector, target: Vector, fov_degrees: float = 45, **attributes: Any) -> int:
        """Adds a camera at `eye` that looks at `target` and returns its index. `fov_degrees`: full vertical angle."""
        transform = look_at(eye, target)
        self.cameras.append(Camera(fov_y_rad=math.radians(fov_degrees), **attributes))
        index = len(self.cameras) - 1
        self.add_node(camera=index, transform=transform)
        return index

    def add_node(self, node: Optional[Node] = None, **attributes: Any) -> int:
        """Adds a node, or one with these attributes, and returns its index."""
        self.nodes.append(node if node is not None else Node(**attributes))
        return len(self.nodes) - 1

    def animate(self, node: int, property: str, times: Any, values: Any, interpolation: str = "linear", *,
                morph_target: int = 0, clip: int = -1) -> None:
        """Adds key frames of a node. `values` has a row per key (three for "cubic-spline"): (n, 3) for "translation" and
        "scale", (n, 4) for "rotation" (quaternions x, y, z, w), (n) for "morph-weight" and "visible"."""
        columns = {"translation": 3, "scale": 3, "rotation": 4, "morph-weight": 1, "visible": 1}.get(property)
        if columns is None:
            raise Error(f"there is no property '{property}'; choose translation, rotation, scale, morph-weight or visible")
        rows = np.asarray(values, np.float32)
        rows = rows[:, None] if rows.ndim == 1 else rows
        if rows.ndim != 2 or rows.shape[1] != columns:
            raise Error(f"the values of '{property}' have the shape {rows.shape}; give {columns} numbers per key")
        padded = np.zeros((len(rows), 4), np.float32)
        padded[:, :columns] = rows
        self.animation.append(AnimationChannel(node=node, property=property, times=times, values=padded,
                                               interpolation=interpolation, morph_target=morph_target, clip=clip))

    def choose_variant(self, name: str) -> None:
        """Gives every mesh its material in the named variant; "": the default materials. Raises Error for other names."""
        _core.choose_variant(self, name)

    def world_matrices(self, time_s: float = 0) -> NDArray[Any]:
        """Matrix from each node to the world at a time: float32, (nodes, 4, 4)."""
        return np.asarray(_core.world_matrices(self, time_s), np.float32).reshape(-1, 4, 4)

    @property
    def animation_end_s(self) -> float:
        """Time of the last key in seconds; 0 without animation."""
        return _core.animation_end(self)

    def find_node(self, name: str) -> int:
        """Index of the first node with that name. Raises Error if there is none."""
        for index, node in enumerate(self.nodes):
            if node.name == name:
                return index
        raise Error(f"scene '{self.name}' has no node '{name}'; Scene.nodes lists all", "not-found")

    def copy(self) -> "Scene":
        """An independent copy."""
        return copy.deepcopy(self)

    def validate(self) -> None:
        """Checks references, array sizes and ranges, as sessions do. Raises Error."""
        _core.validate(self)

    def save(self, file: Path) -> list[str]:
        """Writes .gltf, .glb or .pbrt. Returns the parts that the format stores inexactly, one sentence each. Raises Error
        for other formats, invalid scenes, and if the file cannot be written."""
        return _core.write_scene(os.fspath(file), self)


def load(file: Path) -> Scene:
    """Reads a scene file (glTF, pbrt, Mitsuba XML, OBJ, …; docs/scene-formats.md). Scene.warnings lists ignored parts.

    Raises Error if the file is missing or malformed.
    """
    scene: Scene = _core.load_scene(os.fspath(file))
    return scene


def builtin(name: str) -> Scene:
    """Builds one of the built-in scenes, such as "cornell". Raises Error for an unknown name."""
    scene: Scene = _core.builtin_scene(name)
    return scene


def builtin_scenes() -> dict[str, str]:
    """Names of the built-in scenes, with a line on each."""
    return _core.builtin_scenes()


def load_environment(file: Path) -> Environment:
    """Reads an equirectangular EXR or HDR file. Raises Error if the file is missing or malformed."""
    return _core.load_environment_map(os.fspath(file))


def look_at(eye: Vector, target: Vector) -> Transform:
    """Transform of a node at `eye` whose -Z axis points to `target`, with +Y up."""
    return _core.look_at(eye, target)


def camera_pose(eye: Vector, target: Vector, fov_degrees: float = 45, **attributes: Any) -> CameraPose:
    """A camera at `eye` that looks at `target`, for Session.set_camera(). `fov_degrees`: full vertical angle."""
    scene = Scene()
    scene.add_camera(eye, target, fov_degrees, **attributes)
    return CameraPose(camera=scene.cameras[0], to_world=scene.world_matrices()[0])
