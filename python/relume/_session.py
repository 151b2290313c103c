"""Sessions: frames, images, the state of techniques, and changes of the scene."""

import operator
import os
import weakref
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Optional, Protocol, Union

from numpy.typing import NDArray

from . import _core
from ._core import (CameraPose, Environment, Light, LightHandle, Material, MaterialHandle, Mesh, MeshHandle, Node, NodeHandle,
                    Transform)
from ._errors import Error
from ._image import Image, Path
from ._names import suggestion
from ._progress import progress_bar
from ._scene import Scene
from ._settings import Settings, Value, full_name


class StopFlag(Protocol):
    """Something that another thread sets to end a rendering, such as threading.Event."""

    def is_set(self) -> bool: ...


_STAGES = ("prepare", "hits", "gbuffer", "history", "allocate", "sampled-hits", "trace", "resolve", "present", "denoise")

Hook = Callable[["Session"], None]
Stop = Union[StopFlag, Callable[[], bool], None]


class Session:
    """A scene, its settings, and the frames rendered so far.

    >>> session = relume.Session(relume.builtin("cornell"), 320, 180, lights="vlc")
    >>> session.render(16)
    16
    >>> session.image.shape
    (180, 320, 3)

    Settings are keyword arguments with "_" in place of "." and "-" (docs/settings.md; relume.settings() lists them). They
    replace values of the preset, which replaces those of the scene. The session copies the scene. `movable` lists nodes
    that set_transform() will move. `aovs`: whether to render all layers, also those that no technique needs.
    `crop`: x, y, width and height of the pixels to render; others stay black.
    One thread at a time may use a session: while it renders, other threads get an Error. Several sessions may render at
    once. A session belongs to its process: after a fork (multiprocessing's default), create it in the child.

    Loading a scene and building a session cannot be interrupted.
    """

    def __init__(self, scene: Scene, width: Optional[int] = None, height: Optional[int] = None,
                 preset: Optional[str] = "interactive", *, settings: Optional[Mapping[str, Value]] = None,
                 movable: Optional[list[int]] = None, aovs: bool = True,
                 crop: Optional[tuple[int, int, int, int]] = None, **values: Value) -> None:
        if not isinstance(scene, Scene):
            raise Error(f"a session needs a relume.Scene, not {scene!r}; give relume.load(file) or relume.builtin(name)")
        own = Settings()
        own._core.provide_aovs(aovs)
        if crop is not None:
            own._core.set_crop(*crop)
        if scene.settings_json:
            own.apply_json(scene.settings_json, scene.name or "scene")
        if preset is not None:
            own.apply_preset(preset)
        size = {name: value for name, value in (("width", width), ("height", height)) if value is not None}
        for name, value in {**(settings or {}), **values, **size}.items():
            own[name] = value
        _check_display([*(settings or {}), *values])
        self._core = _core.SessionCore(scene, own._core, movable or [])
        self._settings = own
        self._hooks: dict[str, list[Hook]] = {}
        self._last_of = self._last_passes()

    # --- Frames ---

    def render(self, frames: int = 1, stop: Stop = None, progress: bool = False) -> int:
        """Renders frames: one sample per pixel each. Returns the number of complete ones.

        Fewer are complete if `stop` asked for an end: an object with is_set(), or a function that returns True. It is asked
        before the first frame and every 20 ms; it cannot use the session. Ctrl-C raises KeyboardInterrupt within 100 ms;
        with a radiance cache, after the frame. The image is then that of the last complete frame.
        """
        frames = operator.index(frames)
        if frames < 0:
            raise Error(f"{frames} frames cannot be rendered; give a number from 0")
        if not progress:
            return self._core.render(frames, _asks(stop))
        done = 0
        with progress_bar(frames, "frames") as bar:
            while done < frames and self._core.render(1, _asks(stop)) == 1:
                done += 1
                bar.update(1)
        return done

    def render_until(self, samples: Optional[int] = None, time_s: Optional[float] = None, error: Optional[float] = None,
                     stop: Stop = None, progress: Union[bool, Callable[[float, float, float], None]] = False) -> str:
        """Renders until the first limit is met, and returns its name: "samples", "time", "error" or "interrupted".

        `samples`: samples per pixel since the last change of scene or settings, including those of earlier calls; `time_s`:
        seconds of this call; `error`: relative error of the image (estimated_error). Without any of them, the settings spp,
        time and error apply; their default is 64 samples. `progress`: True shows a bar; a function receives the completed
        fraction, the remaining seconds and the number of samples after each frame.
        """
        if samples is None and time_s is None and error is None:
            samples, time_s, error = self._settings._core.limits()
        limits = (samples or 0, time_s or 0.0, error or 0.0)
        if min(limits) < 0 or max(limits) == 0:
            raise Error("a rendering needs a limit; give samples, time_s or error above 0")
        if progress is not True:
            return self._core.render_until(*limits, progress or None, _asks(stop))
        with progress_bar(100, "%") as bar:

            def report(fraction: float, _remaining_s: float, _samples: float) -> None:
                bar.update(int(100 * fraction) - bar.n)

            return self._core.render_until(*limits, report, _asks(stop))

    @property
    def image(self) -> Image:
        """Mean radiance of the last complete frame, denoised if a denoiser is set: float32, (height, width, 3), read-only.

        Later frames never change an image that was returned. Until the next change, the same memory is returned.
        """
        return self._core.image().view(Image)

    @property
    def frames(self) -> int:
        """Frames since the last change of scene or settings."""
        return self._core.frames()

    @property
    def samples(self) -> float:
        """Mean number of samples per pixel in the image."""
        return self._core.samples()

    @property
    def estimated_error(self) -> float:
        """Estimated relative error of the image; infinite below two samples."""
        return self._core.estimated_error()

    @property
    def statistics(self) -> dict[str, Any]:
        """Times (seconds), counters and bytes since the session began; numbers of the passes as of the last frame.

        "device" describes the GPU and its memory; it is None if the processor renders.
        """
        return self._core.statistics()

    @property
    def notes(self) -> list[str]:
        """Defaults that the session chose for missing parts of the scene."""
        return self._core.notes()

    @property
    def warnings(self) -> list[str]:
        """Problems that affect the results so far."""
        return self._core.warnings()

    @property
    def settings(self) -> Settings:
        """A copy of the settings; change them with set()."""
        return self._settings.copy()

    def set(self, **values: Value) -> None:
        """Changes settings from the next frame on. Raises Error for settings that need a new session."""
        wanted = self._settings.copy()
        for name, value in values.items():
            wanted[name] = value
        _check_display(values)
        if not self._core.set_settings(wanted._core):
            raise Error(f"{', '.join(values)}: the scene would have to be compiled again; create another session")
        self._settings = wanted
        self._last_of = self._last_passes()

    def restart(self, seed: Optional[int] = None) -> None:
        """Discards all samples, histories and caches, and sets the seed if one is given."""
        if seed is not None:
            self._settings["seed"] = seed
        self._core.restart(int(self._settings["seed"]))

    def save_checkpoint(self, file: Path) -> None:
        """Writes the state from which rendering continues bit for bit. Raises Error if the file cannot be written."""
        self._core.save_checkpoint(os.fspath(file))

    def load_checkpoint(self, file: Path) -> None:
        """Continues from such a state. Raises Error if the file is damaged, or the scene or the settings differ."""
        self._core.load_checkpoint(os.fspath(file))

    # --- The state of techniques ---

    @property
    def aovs(self) -> list[str]:
        """Names of the layers that aov() provides."""
        return list(self._settings._core.aov_names())

    def aov(self, name: str) -> NDArray[Any]:
        """A layer as of the last frame: float32, (height, width) or (height, width, channels). Layers that accumulate, such
        as "albedo", are means over the frames since the last change. Raises Error for names that are not in `aovs`."""
        return self._core.aov(name)

    @property
    def buffers(self) -> dict[str, str]:
        """Names of the buffers that buffer() provides, with a line on each."""
        return self._core.buffers()

    def buffer(self, name: str) -> NDArray[Any]:
        """A copy of a buffer's content: float32 or uint32, (height, width) or (height, width, channels). Raises Error for
        names that are not in `buffers`."""
        return self._core.buffer(name)

    def write_buffer(self, name: str, values: Any) -> None:
        """Replaces a buffer's content. In a hook of after(), later passes of the frame read it. Raises Error unless
        `values` has the shape that buffer() returns."""
        self._core.write_buffer(name, values)

    def replace_image(self, image: Any) -> None:
        """Shows `image`, (height, width, 3), in place of the session's until the next frame begins. In a hook of
        after(), this is how a denoiser of your own shows its result. Histories keep their content. Raises Error for
        other shapes."""
        self._core.replace_image(image)

    @property
    def record_tables(self) -> dict[str, str]:
        """Names of the tables that records() provides, with a line on each."""
        return self._core.record_tables()

    def records(self, name: str) -> NDArray[Any]:
        """Records of a technique's data structure, such as "octree.leaves": a copy as a structured array, one element per
        record; its dtype has the names of the fields. Raises Error for names that are not in `record_tables`."""
        return self._core.records(name)

    @property
    def passes(self) -> list[tuple[str, str]]:
        """Name and stage of each pass of a frame, in order."""
        return self._core.passes()

    def after(self, name: str, function: Hook) -> Callable[[], None]:
        """Calls `function(session)` in every frame after a pass, or after the last pass of a stage ("trace").

        A name that is both a pass and a stage means the pass. The function may read the session, write buffers and replace
        the image; other changes raise Error. It runs on another thread, while render() waits. This is slow: buffers are
        copied. Results are deterministic if the function is. An exception ends the frame and is raised by render(). Returns
        a function that removes the hook.
        """
        names = [pass_name for pass_name, _ in self.passes]
        if name not in names and name not in _STAGES:
            raise Error(f"a frame has no pass or stage '{name}'{suggestion(name, [*names, *_STAGES])}", "not-found")
        hooks = self._hooks.setdefault(name, [])
        hooks.append(function)
        self._core.set_hook(_weak_hook(self))

        def remove() -> None:
            if function in hooks:
                hooks.remove(function)
            if not any(self._hooks.values()):
                self._core.set_hook(None)

        return remove

    def _last_passes(self) -> dict[str, str]:
        """Stages that end with a pass, by its name."""
        last_of = {stage: name for name, stage in self.passes}
        return {name: stage for stage, name in last_of.items()}

    def _run_hooks(self, pass_name: str) -> None:
        hooks = list(self._hooks.get(pass_name, []))
        stage = self._last_of.get(pass_name)
        if stage is not None and stage != pass_name and stage not in self._pass_names():
            hooks += self._hooks.get(stage, [])
        for function in hooks:
            function(self)

    def _pass_names(self) -> list[str]:
        return [name for name, _ in self.passes]

    # --- Changes of the scene ---

    def set_time(self, time_s: float) -> None:
        """Moves animated parts to a time."""
        self._core.set_time(time_s)

    @property
    def camera(self) -> CameraPose:
        """The camera that frames are rendered with; change it with set_camera()."""
        return self._core.camera()

    def set_camera(self, camera: Optional[CameraPose]) -> None:
        """Renders with this camera (relume.camera_pose()); None: with the scene's own."""
        self._core.set_camera(camera)

    def set_transform(self, node: Union[NodeHandle, int], transform: Optional[Transform] = None, **attributes: Any) -> None:
        """Moves a node: Session(movable=[...]), add_node() or an animation must allow it. `attributes` are those of a new
        Transform: what is not given is the identity."""
        self._core.set_transform(node, transform if transform is not None else Transform(**attributes))

    def set_light(self, light: Union[LightHandle, int], value: Light) -> None:
        """Replaces a light of the scene. Raises Error for a missing index or an invalid value, as all edits do."""
        self._core.set_light(light, value)

    def set_material(self, material: Union[MaterialHandle, int], value: Material) -> None:
        """Replaces a material of the scene."""
        self._core.set_material(material, value)

    def set_environment(self, environment: Environment) -> None:
        """Replaces the light from infinity."""
        self._core.set_environment(environment)

    def add_material(self, material: Material) -> MaterialHandle:
        """Adds a material; `handle.index` is its index for meshes."""
        return self._core.add_material(material)

    def add_mesh(self, mesh: Mesh) -> MeshHandle:
        """Adds a mesh; `handle.index` is its index for nodes."""
        return self._core.add_mesh(mesh)

    def add_light(self, light: Light) -> LightHandle:
        """Adds a light; `handle.index` is its index for nodes."""
        return self._core.add_light(light)

    def add_node(self, node: Node) -> NodeHandle:
        """Adds a node, which set_transform() may move."""
        return self._core.add_node(node)

    def remove(self, part: Union[NodeHandle, MeshHandle, LightHandle]) -> None:
        """Removes a node with its descendants, or a mesh or light; raises Error if a node uses it."""
        self._core.remove(part)

    def find_node(self, name: str) -> NodeHandle:
        """The first node with that name. Raises Error if there is none."""
        return self._core.find_node(name)

    def _repr_png_(self) -> Union[bytes, None]:
        return self.image._repr_png_()

    def __repr__(self) -> str:
        height, width, _ = self.image.shape
        return f"<relume.Session {width}x{height}, {self.frames} frames, {self.samples:.3g} samples per pixel>"


def _weak_hook(session: Session) -> Callable[[str], None]:
    """Runs the session's hooks. Does not keep the session alive, which owns the function."""
    reference = weakref.ref(session)

    def run(pass_name: str) -> None:
        owner = reference()
        if owner is not None:
            owner._run_hooks(pass_name)

    return run


def _check_display(names: Iterable[str]) -> None:
    """Raises Error for settings of the display, which a session does not use."""
    for name in names:
        if full_name(name) in ("exposure", "tone-map"):
            raise Error(f"a session renders linear values and ignores {name}; use relume.tone_map(image, curve, exposure)")


def _asks(stop: Stop) -> Optional[Callable[[], bool]]:
    if stop is None or callable(stop):
        return stop
    if not hasattr(stop, "is_set"):
        raise Error(f"stop cannot be {stop!r}; give a threading.Event or a function")
    return stop.is_set
