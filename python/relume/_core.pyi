"""Types of the extension module."""

import os
from collections.abc import Callable, Sequence
from typing import Any, Optional, Union, overload

from numpy.typing import ArrayLike, NDArray

__version__: str

Vector = Union[Sequence[float], NDArray[Any]]

class Texture:
    name: str
    format: str
    wrap_u: str
    wrap_v: str
    filter: str
    texels: Any
    def __init__(
        self,
        *,
        name: str = ...,
        format: str = ...,
        wrap_u: str = ...,
        wrap_v: str = ...,
        filter: str = ...,
        texels: Any = ...,
    ) -> None: ...
    def copy(self) -> Texture: ...

class TextureRef:
    texture: int
    uv_set: int
    offset: Vector
    scale: Vector
    rotation_rad: float
    def __init__(
        self,
        *,
        texture: int = ...,
        uv_set: int = ...,
        offset: Vector = ...,
        scale: Vector = ...,
        rotation_rad: float = ...,
    ) -> None: ...
    def copy(self) -> TextureRef: ...

class Material:
    alpha_mode: str
    microfacet_model: str
    name: str
    base_color: Vector
    alpha: float
    base_color_texture: TextureRef
    metallic: float
    roughness: float
    metallic_roughness_texture: TextureRef
    normal_texture: TextureRef
    normal_scale: float
    emission: Vector
    emission_texture: TextureRef
    alpha_cutoff: float
    double_sided: bool
    cull_back_faces: bool
    unlit: bool
    ior: float
    dispersion: float
    specular: float
    specular_texture: TextureRef
    specular_color: Vector
    specular_color_texture: TextureRef
    transmission: float
    transmission_texture: TextureRef
    thickness: float
    attenuation_color: Vector
    attenuation_distance: float
    clearcoat: float
    clearcoat_texture: TextureRef
    clearcoat_roughness: float
    clearcoat_roughness_texture: TextureRef
    clearcoat_normal_texture: TextureRef
    clearcoat_normal_scale: float
    anisotropy: float
    anisotropy_rotation_rad: float
    anisotropy_texture: TextureRef
    sheen_color: Vector
    sheen_color_texture: TextureRef
    sheen_roughness: float
    sheen_roughness_texture: TextureRef
    iridescence: float
    iridescence_texture: TextureRef
    iridescence_ior: float
    iridescence_thickness_min_nm: float
    iridescence_thickness_nm: float
    iridescence_thickness_texture: TextureRef
    diffuse_transmission: float
    diffuse_transmission_texture: TextureRef
    diffuse_transmission_color: Vector
    diffuse_transmission_color_texture: TextureRef
    mix_first: int
    mix_second: int
    mix_share: float
    mix_texture: TextureRef
    def __init__(
        self,
        *,
        alpha_mode: str = ...,
        microfacet_model: str = ...,
        name: str = ...,
        base_color: Vector = ...,
        alpha: float = ...,
        base_color_texture: TextureRef = ...,
        metallic: float = ...,
        roughness: float = ...,
        metallic_roughness_texture: TextureRef = ...,
        normal_texture: TextureRef = ...,
        normal_scale: float = ...,
        emission: Vector = ...,
        emission_texture: TextureRef = ...,
        alpha_cutoff: float = ...,
        double_sided: bool = ...,
        cull_back_faces: bool = ...,
        unlit: bool = ...,
        ior: float = ...,
        dispersion: float = ...,
        specular: float = ...,
        specular_texture: TextureRef = ...,
        specular_color: Vector = ...,
        specular_color_texture: TextureRef = ...,
        transmission: float = ...,
        transmission_texture: TextureRef = ...,
        thickness: float = ...,
        attenuation_color: Vector = ...,
        attenuation_distance: float = ...,
        clearcoat: float = ...,
        clearcoat_texture: TextureRef = ...,
        clearcoat_roughness: float = ...,
        clearcoat_roughness_texture: TextureRef = ...,
        clearcoat_normal_texture: TextureRef = ...,
        clearcoat_normal_scale: float = ...,
        anisotropy: float = ...,
        anisotropy_rotation_rad: float = ...,
        anisotropy_texture: TextureRef = ...,
        sheen_color: Vector = ...,
        sheen_color_texture: TextureRef = ...,
        sheen_roughness: float = ...,
        sheen_roughness_texture: TextureRef = ...,
        iridescence: float = ...,
        iridescence_texture: TextureRef = ...,
        iridescence_ior: float = ...,
        iridescence_thickness_min_nm: float = ...,
        iridescence_thickness_nm: float = ...,
        iridescence_thickness_texture: TextureRef = ...,
        diffuse_transmission: float = ...,
        diffuse_transmission_texture: TextureRef = ...,
        diffuse_transmission_color: Vector = ...,
        diffuse_transmission_color_texture: TextureRef = ...,
        mix_first: int = ...,
        mix_second: int = ...,
        mix_share: float = ...,
        mix_texture: TextureRef = ...,
    ) -> None: ...
    def copy(self) -> Material: ...

class MorphTarget:
    name: str
    positions: Any
    normals: Any
    tangents: Any
    def __init__(
        self,
        *,
        name: str = ...,
        positions: Any = ...,
        normals: Any = ...,
        tangents: Any = ...,
    ) -> None: ...
    def copy(self) -> MorphTarget: ...

class Mesh:
    name: str
    material: int
    positions: Any
    normals: Any
    tangents: Any
    uv0: Any
    uv1: Any
    colors: Any
    triangles: Any
    influences_per_vertex: int
    joints: Any
    weights: Any
    morph_targets: Sequence[MorphTarget]
    def __init__(
        self,
        *,
        name: str = ...,
        material: int = ...,
        positions: Any = ...,
        normals: Any = ...,
        tangents: Any = ...,
        uv0: Any = ...,
        uv1: Any = ...,
        colors: Any = ...,
        triangles: Any = ...,
        influences_per_vertex: int = ...,
        joints: Any = ...,
        weights: Any = ...,
        morph_targets: Sequence[MorphTarget] = ...,
    ) -> None: ...
    def copy(self) -> Mesh: ...

class Skin:
    name: str
    joints: Sequence[int]
    inverse_bind: Sequence[ArrayLike]
    def __init__(
        self,
        *,
        name: str = ...,
        joints: Sequence[int] = ...,
        inverse_bind: Sequence[ArrayLike] = ...,
    ) -> None: ...
    def copy(self) -> Skin: ...

class Light:
    type: str
    name: str
    intensity: Vector
    inner_cone_rad: float
    outer_cone_rad: float
    angular_diameter_rad: float
    def __init__(
        self,
        *,
        type: str = ...,
        name: str = ...,
        intensity: Vector = ...,
        inner_cone_rad: float = ...,
        outer_cone_rad: float = ...,
        angular_diameter_rad: float = ...,
    ) -> None: ...
    def copy(self) -> Light: ...

class SunSky:
    sun_elevation_rad: float
    sun_azimuth_rad: float
    turbidity: float
    sky_scale: float
    sun_scale: float
    sun_angular_diameter_rad: float
    ground_albedo: Vector
    def __init__(
        self,
        *,
        sun_elevation_rad: float = ...,
        sun_azimuth_rad: float = ...,
        turbidity: float = ...,
        sky_scale: float = ...,
        sun_scale: float = ...,
        sun_angular_diameter_rad: float = ...,
        ground_albedo: Vector = ...,
    ) -> None: ...
    def copy(self) -> SunSky: ...

class Environment:
    kind: str
    color: Vector
    rotation_rad: float
    sun_sky: SunSky
    map: Any
    def __init__(
        self,
        *,
        kind: str = ...,
        color: Vector = ...,
        rotation_rad: float = ...,
        sun_sky: SunSky = ...,
        map: Any = ...,
    ) -> None: ...
    def copy(self) -> Environment: ...

class Camera:
    projection: str
    name: str
    fov_y_rad: float
    half_height: float
    aspect_ratio: float
    lens_radius: float
    focus_distance: float
    def __init__(
        self,
        *,
        projection: str = ...,
        name: str = ...,
        fov_y_rad: float = ...,
        half_height: float = ...,
        aspect_ratio: float = ...,
        lens_radius: float = ...,
        focus_distance: float = ...,
    ) -> None: ...
    def copy(self) -> Camera: ...

class CameraPose:
    camera: Camera
    to_world: Any
    def __init__(
        self,
        *,
        camera: Camera = ...,
        to_world: Any = ...,
    ) -> None: ...
    def copy(self) -> CameraPose: ...

class Transform:
    translation: Vector
    rotation: Vector
    scale: Vector
    def __init__(
        self,
        *,
        translation: Vector = ...,
        rotation: Vector = ...,
        scale: Vector = ...,
    ) -> None: ...
    def copy(self) -> Transform: ...

class Node:
    name: str
    parent: int
    transform: Transform
    matrix: Any
    light: int
    camera: int
    skin: int
    visible: bool
    meshes: Sequence[int]
    instances: Sequence[ArrayLike]
    morph_weights: Any
    def __init__(
        self,
        *,
        name: str = ...,
        parent: int = ...,
        transform: Transform = ...,
        matrix: Any = ...,
        light: int = ...,
        camera: int = ...,
        skin: int = ...,
        visible: bool = ...,
        meshes: Sequence[int] = ...,
        instances: Sequence[ArrayLike] = ...,
        morph_weights: Any = ...,
    ) -> None: ...
    def copy(self) -> Node: ...

class AnimationChannel:
    property: str
    interpolation: str
    node: int
    morph_target: int
    clip: int
    times: Any
    values: Any
    def __init__(
        self,
        *,
        property: str = ...,
        interpolation: str = ...,
        node: int = ...,
        morph_target: int = ...,
        clip: int = ...,
        times: Any = ...,
        values: Any = ...,
    ) -> None: ...
    def copy(self) -> AnimationChannel: ...

class ParameterChannel:
    part: str
    interpolation: str
    index: int
    parameter: str
    clip: int
    times: Any
    values: Any
    def __init__(
        self,
        *,
        part: str = ...,
        interpolation: str = ...,
        index: int = ...,
        parameter: str = ...,
        clip: int = ...,
        times: Any = ...,
        values: Any = ...,
    ) -> None: ...
    def copy(self) -> ParameterChannel: ...

class NodeHandle:
    def __init__(self, index: int) -> None: ...
    @property
    def index(self) -> int: ...

class MeshHandle:
    def __init__(self, index: int) -> None: ...
    @property
    def index(self) -> int: ...

class MaterialHandle:
    def __init__(self, index: int) -> None: ...
    @property
    def index(self) -> int: ...

class LightHandle:
    def __init__(self, index: int) -> None: ...
    @property
    def index(self) -> int: ...

class SettingsCore:
    @overload
    def __init__(self) -> None: ...
    @overload
    def __init__(self, other: SettingsCore) -> None: ...
    def set(self, name: str, value: Union[str, int, float, bool]) -> None: ...
    def get(self, name: str) -> str: ...
    def apply_preset(self, name: str) -> None: ...
    def apply_json(self, json: str, place: str) -> None: ...
    def provide_aovs(self, provided: bool) -> None: ...
    def set_crop(self, x: int, y: int, width: int, height: int) -> None: ...
    def limits(self) -> tuple[int, float, float]: ...
    def aov_names(self) -> list[str]: ...
    def to_json(self) -> str: ...

class SessionCore:
    def __init__(self, scene: Any, settings: SettingsCore, movable: list[int]) -> None: ...
    def render(self, frames: int, wants_stop: Optional[Callable[[], bool]]) -> int: ...
    def render_until(
        self,
        samples: int,
        time_s: float,
        error: float,
        progress: Optional[Callable[[float, float, float], None]],
        wants_stop: Optional[Callable[[], bool]],
    ) -> str: ...
    def image(self) -> NDArray[Any]: ...
    def aov(self, name: str) -> NDArray[Any]: ...
    def buffers(self) -> dict[str, str]: ...
    def buffer(self, name: str) -> NDArray[Any]: ...
    def write_buffer(self, name: str, values: Any) -> None: ...
    def replace_image(self, image: Any) -> None: ...
    def record_tables(self) -> dict[str, str]: ...
    def records(self, name: str) -> NDArray[Any]: ...
    def passes(self) -> list[tuple[str, str]]: ...
    def set_hook(self, hook: Optional[Callable[[str], None]]) -> None: ...
    def statistics(self) -> dict[str, Any]: ...
    def frames(self) -> int: ...
    def samples(self) -> float: ...
    def estimated_error(self) -> float: ...
    def notes(self) -> list[str]: ...
    def warnings(self) -> list[str]: ...
    def save_checkpoint(self, file: str) -> None: ...
    def load_checkpoint(self, file: str) -> None: ...
    def restart(self, seed: int) -> None: ...
    def set_settings(self, settings: SettingsCore) -> bool: ...
    def set_time(self, time_s: float) -> None: ...
    def camera(self) -> CameraPose: ...
    def set_camera(self, camera: Optional[CameraPose]) -> None: ...
    def set_transform(self, node: Union[NodeHandle, int], transform: Transform) -> None: ...
    def set_light(self, light: Union[LightHandle, int], value: Light) -> None: ...
    def set_environment(self, environment: Environment) -> None: ...
    def set_material(self, material: Union[MaterialHandle, int], value: Material) -> None: ...
    def add_material(self, material: Material) -> MaterialHandle: ...
    def add_mesh(self, mesh: Mesh) -> MeshHandle: ...
    def add_light(self, light: Light) -> LightHandle: ...
    def add_node(self, node: Node) -> NodeHandle: ...
    def remove(self, part: Union[NodeHandle, MeshHandle, LightHandle]) -> None: ...
    def find_node(self, name: str) -> NodeHandle: ...

def list_settings() -> list[tuple[str, str, str, str]]: ...
def list_presets() -> list[str]: ...
def load_scene(file: str) -> Any: ...
def builtin_scene(name: str) -> Any: ...
def builtin_scenes() -> dict[str, str]: ...
def write_scene(file: str, scene: Any) -> list[str]: ...
def validate(scene: Any) -> None: ...
def load_environment_map(file: str) -> Environment: ...
def choose_variant(scene: Any, name: str) -> None: ...
def world_matrices(scene: Any, time_s: float) -> list[NDArray[Any]]: ...
def animation_end(scene: Any) -> float: ...
def look_at(eye: Vector, target: Vector) -> Transform: ...
def read_image(file: str) -> NDArray[Any]: ...
def write_image(file: str, image: Any) -> None: ...
def read_exr_channels(file: str) -> dict[str, NDArray[Any]]: ...
def end_workers() -> None: ...
def read_exr_attributes(file: str) -> dict[str, str]: ...
def write_exr_channels(file: str, channels: dict[str, Any], attributes: dict[str, str]) -> None: ...
def merge(parts: list[str], output: str, keep_sums: bool) -> int: ...
def tone_map(image: Any, curve: str, exposure: float) -> NDArray[Any]: ...
def encode_png(image: Any) -> bytes: ...
def writable_alias(array: NDArray[Any]) -> NDArray[Any]: ...
def metrics(a: Any, b: Any, flip: bool) -> dict[str, float]: ...
def flip_map(a: Any, b: Any) -> NDArray[Any]: ...
def compare(
    scene: Any, request: dict[str, Any], progress: Optional[Callable[[str, float], None]]
) -> Optional[dict[str, Any]]: ...
def experiments() -> dict[str, str]: ...
def experiment(
    name: str, quick: bool, cache: str, scenes: str, device: str, progress: Optional[Callable[[str, float], None]]
) -> Optional[dict[str, Any]]: ...
