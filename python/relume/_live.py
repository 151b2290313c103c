"""A live view of a session in a notebook."""

import atexit
import queue
import threading
import time
import weakref
from collections.abc import Callable
from typing import Any, Optional

from . import _core
from ._core import CameraPose
from ._errors import Error
from ._image import to_png
from ._navigation import dolly, orbit, pan, pivot_distance
from ._session import Session

RADIANS_PER_WIDTH = 3.0
"""Turn for a drag across the whole image."""

SECONDS_BETWEEN_IMAGES = 0.05

_VIEWS: "weakref.WeakKeyDictionary[Session, LiveView]" = weakref.WeakKeyDictionary()


@atexit.register
def _stop_all() -> None:
    """Ends the threads before the interpreter, which they use, ends."""
    for view in list(_VIEWS.values()):
        view._stop.set()
        view._thread.join()
    _core.end_workers()


_SCRIPT = """
function render({ model, el }) {
  const image = document.createElement("img");
  image.style.cssText = "max-width: 100%; cursor: grab; touch-action: none";
  image.draggable = false;
  const show = () => {
    const bytes = model.get("png");
    if (!bytes || bytes.byteLength === 0) return;
    const old = image.src;
    image.src = URL.createObjectURL(new Blob([bytes], { type: "image/png" }));
    if (old) URL.revokeObjectURL(old);
  };
  const share = (pixels) => pixels / image.clientWidth;
  image.addEventListener("pointerdown", (event) => image.setPointerCapture(event.pointerId));
  image.addEventListener("pointermove", (event) => {
    if (event.buttons === 0) return;
    const kind = event.shiftKey || event.buttons !== 1 ? "pan" : "orbit";
    model.send({ kind, right: share(event.movementX), down: share(event.movementY) });
  });
  image.addEventListener("contextmenu", (event) => event.preventDefault());
  image.addEventListener("wheel", (event) => {
    event.preventDefault();
    model.send({ kind: "dolly", down: event.deltaY / 1000 });
  }, { passive: false });
  model.on("change:png", show);
  el.appendChild(image);
  show();
}
export default { render };
"""


class LiveView:
    """Renders a session on a thread and shows the image, at most 20 times per second, until stop().

    The session belongs to this thread meanwhile: change it with edit(), and read `image`.
    """

    def __init__(self, session: Session, show: Callable[[bytes], None], frames: int = 256) -> None:
        other = _VIEWS.get(session)
        if other is not None:
            other.stop()
        self.image = session.image
        self._session = session
        self._show = show
        self._frames = frames
        self._edits: "queue.Queue[Callable[[Session], None]]" = queue.Queue()
        self._stop = threading.Event()
        self._failure: Optional[BaseException] = None
        self._distance: Optional[float] = None
        self._shown_s = 0.0
        self._thread = threading.Thread(target=self._run, daemon=True)
        _VIEWS[session] = self
        self._thread.start()

    def edit(self, change: Callable[[Session], None]) -> None:
        """Calls `change(session)` before the next frame. Raises Error if the view has ended."""
        if self._failure is not None:
            raise Error(f"the live view has ended: {self._failure}; call relume.live() again") from self._failure
        self._edits.put(change)

    def orbit(self, right: float, down: float) -> None:
        """Turns the camera by a drag; 1: across the width of the image."""
        self.edit(lambda s: self._move(
            s, lambda pose, distance: orbit(pose, distance, -RADIANS_PER_WIDTH * right, RADIANS_PER_WIDTH * down)))

    def pan(self, right: float, down: float) -> None:
        """Moves the camera so that the surface in the middle follows a drag."""
        self.edit(lambda s: self._move(s, lambda pose, distance: pan(pose, -distance * right, distance * down)))

    def dolly(self, down: float) -> None:
        """Moves the camera towards the surface in the middle (negative), or away from it."""
        self.edit(lambda s: self._move(s, lambda pose, distance: dolly(pose, distance, 2.0**down)))

    def stop(self) -> None:
        """Ends the thread. Raises the exception that ended it before, if any."""
        self._stop.set()
        self._thread.join()
        if _VIEWS.get(self._session) is self:
            del _VIEWS[self._session]
        if self._failure is not None:
            raise self._failure

    def _move(self, session: Session, moved: Callable[[CameraPose, float], CameraPose]) -> None:
        if self._distance is None:
            self._distance = pivot_distance(session)
        session.set_camera(moved(session.camera, self._distance))

    def _run(self) -> None:
        try:
            while not self._stop.is_set():
                self._apply_edits()
                if self._session.frames < self._frames:
                    self._session.render(1, stop=self._stop)
                    self.image = self._session.image
                    self._show_sometimes()
        except BaseException as failure:
            self._failure = failure

    def _show_sometimes(self) -> None:
        is_last = self._session.frames >= self._frames
        if is_last or time.monotonic() - self._shown_s > SECONDS_BETWEEN_IMAGES:
            self._show(to_png(self.image))
            self._shown_s = time.monotonic()

    def _apply_edits(self) -> None:
        """Applies all waiting edits; waits for one if the image is complete."""
        complete = self._session.frames >= self._frames
        try:
            self._edits.get(block=complete, timeout=0.1)(self._session)
            while True:
                self._edits.get_nowait()(self._session)
        except queue.Empty:
            if not complete:
                self._distance = None  # the camera rests: the pivot may lie elsewhere next time


def live(session: Session, frames: int = 256) -> Any:
    """Shows a session in a notebook: an image that refines up to `frames` frames.

    Drag to orbit, drag with Shift or another button to pan, turn the wheel to approach. `result.view` is the LiveView;
    `result.view.stop()` ends it, and so does another live() of the session. Mouse input needs the package anywidget. With ipywidgets alone, buttons move the camera.
    Without both, the result is a sentence that says so.
    """
    for make in (_with_anywidget, _with_ipywidgets):
        try:
            return make(session, frames)
        except ImportError:
            continue
    return "relume.live() needs the package anywidget (or ipywidgets, for buttons in place of the mouse); install one of them"


def _with_anywidget(session: Session, frames: int) -> Any:
    import anywidget
    import traitlets

    class Canvas(anywidget.AnyWidget):  # type: ignore[misc]
        _esm = _SCRIPT
        png = traitlets.Bytes(b"").tag(sync=True)  # type: ignore[no-untyped-call]

    canvas = Canvas()
    view = LiveView(session, lambda png: setattr(canvas, "png", png), frames)

    def receive(_widget: Any, message: dict[str, Any], _buffers: Any) -> None:
        moves: dict[str, Callable[..., None]] = {"orbit": view.orbit, "pan": view.pan, "dolly": view.dolly}
        moves[message.pop("kind")](**message)

    canvas.on_msg(receive)
    canvas.view = view
    return canvas


def _with_ipywidgets(session: Session, frames: int) -> Any:
    import ipywidgets

    picture = ipywidgets.Image(format="png")
    view = LiveView(session, lambda png: setattr(picture, "value", png), frames)
    moves = {"left": (view.orbit, (0.1, 0)), "right": (view.orbit, (-0.1, 0)), "up": (view.orbit, (0, 0.05)),
             "down": (view.orbit, (0, -0.05)), "nearer": (view.dolly, (-0.25,)), "farther": (view.dolly, (0.25,))}
    buttons = []
    for name, (move, values) in moves.items():
        button = ipywidgets.Button(description=name)
        button.on_click(lambda _button, move=move, values=values: move(*values))
        buttons.append(button)
    box = ipywidgets.VBox([picture, ipywidgets.HBox(buttons)])
    box.view = view
    return box
