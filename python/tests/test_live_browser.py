"""The live view's script in Chromium. A stand-in replaces the model that anywidget passes to it."""

import base64
import shutil

import numpy as np
import pytest
import relume
from relume import _live

webdriver = pytest.importorskip("selenium.webdriver")
from selenium.webdriver.chrome.service import Service  # noqa: E402
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
from selenium.webdriver.common.actions.action_builder import ActionBuilder  # noqa: E402
from selenium.webdriver.common.actions.mouse_button import MouseButton  # noqa: E402
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin  # noqa: E402
from selenium.webdriver.common.keys import Keys  # noqa: E402
from selenium.webdriver.support.ui import WebDriverWait  # noqa: E402

CHROMIUM = shutil.which("chromium")
DRIVER = shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(not CHROMIUM or not DRIVER, reason="Chromium or its driver is not installed")

WIDTH, HEIGHT = 64, 48

# Loads the script as anywidget does: as a module from memory.
START = """
const [script, done] = arguments;
window.values = {};
window.sent = [];
const model = {
  get: (name) => window.values[name],
  on: (event, changed) => { window[event] = changed; },
  send: (message) => window.sent.push(message),
};
import(URL.createObjectURL(new Blob([script], { type: "text/javascript" })))
  .then((module) => { module.default.render({ model, el: document.body }); done(""); }, (error) => done(String(error)));
"""

SHOW = """
window.values.png = new DataView(Uint8Array.from(atob(arguments[0]), (c) => c.charCodeAt(0)).buffer);
window["change:png"]();
"""


@pytest.fixture(scope="module")
def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--host-resolver-rules=MAP * ~NOTFOUND"):
        options.add_argument(argument)
    started = webdriver.Chrome(service=Service(DRIVER), options=options)
    yield started
    started.quit()


@pytest.fixture
def canvas(browser):
    """The image of a view that has received its first image."""
    browser.get("data:text/html,<!doctype html><title>live</title>")
    assert browser.execute_async_script(START, _live._SCRIPT) == ""
    image = browser.find_element("css selector", "img")
    assert not image.get_attribute("src")
    show(browser, image, 0.25)
    return image


def show(browser, image, value):
    """Sends an image of one value, and waits until the browser shows it."""
    before = image.get_attribute("src")
    png = relume._image.to_png(np.full((HEIGHT, WIDTH, 3), value, np.float32))
    browser.execute_script(SHOW, base64.b64encode(png).decode())
    WebDriverWait(browser, 20, 0.05).until(lambda _: image.get_attribute("src") != before)
    WebDriverWait(browser, 20, 0.05).until(lambda _: image.get_property("naturalWidth") == WIDTH)


def sum_of_moves(browser, kind):
    """The number of messages, and the sums of their parts; fails if one has another kind."""
    sent = browser.execute_script("return window.sent.splice(0)")
    assert {message["kind"] for message in sent} == {kind}
    return [sum(message.get(part, 0) for message in sent) for part in ("right", "down")]


def drag(browser, image, button=MouseButton.LEFT):
    """Drags by half of the width and a quarter of the width upwards."""
    actions = ActionBuilder(browser)
    mouse = actions.pointer_action
    mouse.move_to(image, 0, 0).pointer_down(button=button).move_by(WIDTH // 4, -WIDTH // 8).move_by(WIDTH // 4, -WIDTH // 8)
    mouse.pointer_up(button=button)
    actions.perform()


def test_images_replace_each_other(browser, canvas):
    pixel = """
const [image, done] = arguments;
const copy = document.createElement("canvas");
image.decode().then(() => {
  const context = copy.getContext("2d");
  context.drawImage(image, 0, 0);
  done([...context.getImageData(3, 3, 1, 1).data]);
});
"""
    dark = browser.execute_async_script(pixel, canvas)
    show(browser, canvas, 0.75)
    bright = browser.execute_async_script(pixel, canvas)
    assert 0 < dark[0] < bright[0] < 255
    assert canvas.get_property("naturalHeight") == HEIGHT


def test_drags_orbit(browser, canvas):
    drag(browser, canvas)
    assert sum_of_moves(browser, "orbit") == pytest.approx([0.5, -0.25])


def test_drags_with_shift_or_another_button_pan(browser, canvas):
    drag(browser, canvas, MouseButton.RIGHT)
    assert sum_of_moves(browser, "pan") == pytest.approx([0.5, -0.25])
    ActionChains(browser).key_down(Keys.SHIFT).drag_and_drop_by_offset(canvas, WIDTH // 2, 0).key_up(Keys.SHIFT).perform()
    assert sum_of_moves(browser, "pan") == pytest.approx([0.5, 0])


def test_a_mouse_without_pressed_buttons_moves_nothing(browser, canvas):
    ActionChains(browser).move_to_element(canvas).move_by_offset(10, 5).perform()
    assert browser.execute_script("return window.sent") == []


def test_the_wheel_approaches(browser, canvas):
    ActionChains(browser).scroll_from_origin(ScrollOrigin.from_element(canvas), 0, -250).perform()
    WebDriverWait(browser, 20, 0.05).until(lambda _: browser.execute_script("return window.sent.length") > 0)
    assert sum_of_moves(browser, "dolly") == pytest.approx([0, -0.25])
