"""The live view of notebooks. A stand-in replaces anywidget, which Debian does not package."""

import builtins
import sys
import threading
import types

import numpy as np
import pytest
import relume
from relume import _live, _navigation


@pytest.fixture
def session():
    return relume.Session(relume.builtin("cornell"), 32, 24, preset=None)


class Shown:
    """Receives images and waits for them."""

    def __init__(self):
        self.images = []
        self.changed = threading.Condition()

    def __call__(self, png):
        with self.changed:
            self.images.append(png)
            self.changed.notify_all()

    def wait_for(self, count):
        with self.changed:
            assert self.changed.wait_for(lambda: len(self.images) >= count, timeout=60)


def test_the_view_refines_up_to_its_limit_and_follows_the_mouse(session, monkeypatch):
    monkeypatch.setattr(_live, "SECONDS_BETWEEN_IMAGES", 0)
    shown = Shown()
    view = _live.LiveView(session, shown, frames=3)
    shown.wait_for(3)
    view.orbit(0.2, 0.1)
    view.dolly(-0.5)
    view.pan(0.1, 0)
    shown.wait_for(6)
    view.stop()
    assert all(image.startswith(b"\x89PNG") for image in shown.images)
    assert len(set(shown.images)) == len(shown.images)
    assert session.frames <= 3


def test_failures_end_the_view_and_are_raised(session):
    view = _live.LiveView(session, lambda _png: None, frames=2)
    view.edit(lambda _session: 1 / 0)
    view._thread.join(60)
    with pytest.raises(ZeroDivisionError):
        view.stop()


def test_the_canvas_passes_messages_to_the_view(session, monkeypatch):
    class AnyWidget:
        def on_msg(self, receive):
            self.receive = receive

    monkeypatch.setitem(sys.modules, "anywidget", types.SimpleNamespace(AnyWidget=AnyWidget))
    traits = types.SimpleNamespace(Bytes=lambda value: types.SimpleNamespace(tag=lambda sync: value))
    monkeypatch.setitem(sys.modules, "traitlets", traits)
    before = np.array(session.camera.to_world)
    canvas = relume.live(session, frames=2)
    for message in ({"kind": "orbit", "right": 0.1, "down": 0}, {"kind": "dolly", "down": 0.5}):
        canvas.receive(canvas, message, [])
    moved = threading.Event()
    canvas.view.edit(lambda _session: moved.set())
    assert moved.wait(60)
    canvas.view.stop()
    assert canvas.png.startswith(b"\x89PNG")
    assert not np.allclose(session.camera.to_world, before)


def test_buttons_move_the_camera_where_only_ipywidgets_is_installed(session, monkeypatch):
    class Widget:
        def __init__(self, *_arguments, **attributes):
            self.__dict__.update(attributes)

        def on_click(self, function):
            self.click = lambda: function(self)

    buttons = []

    class Button(Widget):
        def __init__(self, **attributes):
            super().__init__(**attributes)
            buttons.append(self)

    monkeypatch.setitem(sys.modules, "anywidget", None)
    widgets = types.SimpleNamespace(Image=Widget, VBox=Widget, HBox=Widget, Button=Button)
    monkeypatch.setitem(sys.modules, "ipywidgets", widgets)
    before = np.array(session.camera.to_world)
    box = relume.live(session, frames=2)
    for button in buttons[::2]:  # pairs would cancel out
        button.click()
    moved = threading.Event()
    box.view.edit(lambda _session: moved.set())
    assert moved.wait(60)
    box.view.stop()
    assert [button.description for button in buttons] == ["left", "right", "up", "down", "nearer", "farther"]
    assert not np.allclose(session.camera.to_world, before)


def test_another_view_ends_the_first(session):
    first = relume.LiveView(session, lambda _png: None)
    second = relume.LiveView(session, lambda _png: None)
    assert not first._thread.is_alive()
    assert second._thread.is_alive()
    second.stop()


def test_without_widgets_a_sentence_says_what_is_missing(session, monkeypatch):
    real_import = builtins.__import__

    def without_widgets(name, *arguments, **options):
        if name in ("anywidget", "ipywidgets"):
            raise ImportError(name)
        return real_import(name, *arguments, **options)

    monkeypatch.setattr(builtins, "__import__", without_widgets)
    assert "anywidget" in relume.live(session)


def test_orbits_keep_the_pivot_and_the_horizon():
    pose = relume.camera_pose((0, 1, 4), (0, 1, 0))
    moved = np.array(_navigation.orbit(pose, 4, 0.3, 0.2).to_world)
    np.testing.assert_allclose(moved[:3, 3] - 4 * moved[:3, 2], [0, 1, 0], atol=1e-5)
    np.testing.assert_allclose(moved[:3, :3] @ moved[:3, :3].T, np.eye(3), atol=1e-5)
    assert moved[1, 0] == pytest.approx(0, abs=1e-6), "the horizon stays level"
    assert moved[1, 3] > 1, "dragging down raises the camera"
    steep = _navigation.orbit(pose, 4, 0, 10)
    assert np.array(steep.to_world)[1, 2] < 1


def test_dolly_and_pan():
    pose = relume.camera_pose((0, 1, 4), (0, 1, 0))
    np.testing.assert_allclose(np.array(_navigation.dolly(pose, 4, 0.5).to_world)[:3, 3], [0, 1, 2], atol=1e-6)
    np.testing.assert_allclose(np.array(_navigation.pan(pose, 1, 2).to_world)[:3, 3], [1, 3, 4], atol=1e-6)
    assert _navigation.pivot_distance(relume.Session(relume.builtin("cornell"), 16, 16, preset=None, aovs=False)) == 1
