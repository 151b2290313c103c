"""relume: a real-time path tracer that reuses samples across pixels, frames and paths.

>>> import relume
>>> session = relume.Session(relume.builtin("cornell"), 320, 180)
>>> session.render(64)
64
>>> relume.write_image("cornell.png", relume.tone_map(session.image))

load() and builtin() give scenes, Session renders them, compare() measures techniques against a reference, and
relume.metrics measures images. docs/python.md introduces them.
"""

from . import metrics
from ._comparison import Comparison, ExperimentReport, compare, experiment, experiments
from ._core import LightHandle, MaterialHandle, MeshHandle, NodeHandle, __version__
from ._errors import Error
from ._image import Image, merge, read_exr, read_exr_attributes, read_image, to_png, tone_map, write_exr, write_image
from ._live import LiveView, live
from ._parts import make_values
from ._scene import (AnimationChannel, Camera, CameraPose, Environment, Light, Material, Mesh, MorphTarget, Node,
                     ParameterChannel, Scene, Skin, SunSky, Texture, TextureRef, Transform, builtin, builtin_scenes, camera_pose,
                     load, load_environment, look_at)
from ._session import Session
from ._settings import SettingInfo, Settings, presets, settings

__all__ = [
    "AnimationChannel", "Camera", "CameraPose", "Comparison", "Environment", "Error", "ExperimentReport", "Image", "Light",
    "LightHandle", "LiveView", "Material", "MaterialHandle", "Mesh", "MeshHandle", "MorphTarget", "Node", "NodeHandle", "ParameterChannel",
    "Scene", "Session", "SettingInfo", "Settings", "Skin", "SunSky", "Texture", "TextureRef", "Transform", "__version__",
    "builtin", "builtin_scenes", "camera_pose", "compare", "experiment", "experiments", "live", "load", "load_environment",
    "look_at", "merge", "metrics", "presets", "read_exr", "read_exr_attributes", "read_image", "settings", "to_png", "tone_map", "write_exr", "write_image",
]

make_values()
