#!/usr/bin/env python3
"""Tests the page of `relume serve` in Chromium: image, camera, settings, buffers, screenshot, rates. Needs Chromium and selenium."""

import json
import os
import pathlib
import sys
import tempfile
import time
import unittest

import page_test
from png import png_pixels
from program import run
from serve_client import Server

# For otherwise idle machines: requires rates instead of only reporting them.
QUIET = os.environ.get("RELUME_QUIET_MACHINE") == "1"
PATIENCE_S = 120

MEAN = """
const image = document.getElementById("image");
const data = image.getContext("2d").getImageData(0, 0, image.width, image.height).data;
let sum = 0;
for (let i = 0; i < data.length; i += 4) sum += data[i] + data[i + 1] + data[i + 2];
return sum / (data.length / 4 * 3);
"""

# Of the columns left and right of the middle.
MEANS_OF_HALVES = """
const image = document.getElementById("image");
const half = Math.floor(image.width / 2);
return [0, image.width - half].map((from) => {
  const data = image.getContext("2d").getImageData(from, 0, half, image.height).data;
  let sum = 0;
  for (let i = 0; i < data.length; i += 4) sum += data[i] + data[i + 1] + data[i + 2];
  return sum / (data.length / 4 * 3);
});
"""


class Browser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # It renders during the whole test: one thread, where no rates are required.
        threads = () if QUIET else ("--threads", 1)
        cls.server = Server("cornell", "--width", 640, "--height", 360, "--max-bounces", 3, *threads)
        cls.addClassCleanup(cls.server.close)
        folder = tempfile.TemporaryDirectory(prefix="relume_")
        cls.addClassCleanup(folder.cleanup)
        cls.downloads = pathlib.Path(folder.name)
        cls.browser = page_test.start_browser("MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", {"download.default_directory": folder.name})
        cls.addClassCleanup(cls.browser.quit)
        cls.browser.set_script_timeout(PATIENCE_S)

    # Whether the last test left the page to the next one. Loading it takes longer than most tests.
    is_kept = False

    def setUp(self):
        kept, Browser.is_kept = Browser.is_kept, False
        if not kept:
            self.open()

    def open(self):
        self.browser.get("about:blank")
        self.browser.get(self.server.address)
        self.wait(lambda: self.js("return Boolean(globalThis.relume && relume.state.frames > 1 && relume.state.values && relume.state.status?.eye)"))
        self.wait(lambda: self.js("return relume.state.role.viewer === relume.state.role.steerer"))

    def tearDown(self):
        self.assertTrue(self.server.alive, "".join(self.server.errors))

    def keep_page(self):
        """Ends a test that leaves the page as the next one needs it: it steers, and no message covers it."""
        Browser.is_kept = True

    def js(self, script, *arguments):
        return self.browser.execute_script(script, *arguments)

    def wait(self, condition):
        """Also repeats a condition whose elements the page replaced after their search, as when a list of buttons changes."""
        page_test.WebDriverWait(self.browser, PATIENCE_S, page_test.POLL_S, [page_test.Stale]).until(lambda _: condition())

    def one(self, selector):
        return self.browser.find_element(page_test.By.CSS_SELECTOR, selector)

    def click(self, selector):
        self.wait(lambda: self.one(selector).click() or True)

    def choose(self, setting, text):
        self.wait(lambda: page_test.Select(self.one(f"select[data-setting='{setting}']")).select_by_visible_text(text) or True)

    def status(self):
        return self.js("return relume.state.status")

    def hold(self, key, seconds):
        self.click("#image")
        page_test.ActionChains(self.browser).key_down(key).pause(seconds).key_up(key).perform()

    def test_opens_without_errors_and_is_not_black(self):
        self.assertEqual([entry["message"] for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"], [])
        self.wait(lambda: self.js(MEAN) > 20)
        self.assertNotIn("#", self.browser.current_url, "the token leaves the address bar")
        self.assertEqual(self.js("return document.getElementById('notice').hidden"), True)
        sources = self.js("return performance.getEntriesByType('resource').map((e) => e.name)")
        self.assertTrue(all(source.startswith((f"http://{self.server.host}/", "blob:", "data:")) for source in sources), sources)
        self.browser.refresh()
        self.wait(lambda: self.js("return Boolean(globalThis.relume && relume.state.frames > 1)"))

    def test_a_page_without_its_token_says_so(self):
        self.js("sessionStorage.clear()")
        self.browser.get(f"http://{self.server.host}/")
        self.wait(lambda: "token" in self.one("#notice").text)
        self.assertEqual(self.js("return relume.state.frames"), 0)

    def test_w_moves_the_camera(self):
        before = self.status()
        self.hold("w", 0.5)
        self.wait(lambda: self.status()["eye"] != before["eye"])
        time.sleep(1)
        after = self.status()
        moved = [b - a for a, b in zip(before["eye"], after["eye"])]
        self.assertGreater(sum(m * f for m, f in zip(moved, before["forward"])), 0, "forwards")
        time.sleep(1)
        self.assertEqual(self.status()["eye"], after["eye"], "the camera stops with the key")

    def test_a_drag_turns_the_camera(self):
        before = self.status()
        page_test.ActionChains(self.browser).drag_and_drop_by_offset(self.one("#image"), 80, 0).perform()
        self.wait(lambda: self.status()["forward"] != before["forward"])
        self.keep_page()

    def test_a_slot_changes(self):
        before = page_test.Select(self.one("select[data-setting='denoise']")).first_selected_option.text
        wanted = "none" if before != "none" else "bmfr"
        self.choose("denoise", wanted)
        self.wait(lambda: self.js("return relume.state.values.sides[0].denoise") == wanted)
        self.wait(lambda: any(p["name"] for p in self.status()["times"][0]["passes"]))
        self.choose("denoise", before)
        self.wait(lambda: self.js("return relume.state.values.sides[0].denoise") == before)
        self.keep_page()

    def test_values_out_of_range_give_a_message(self):
        self.js("relume.link.input({ do: 'set', side: 0, name: 'max-bounces', value: '-1' })")
        self.wait(lambda: any("max-bounces" in message["text"] for message in self.status()["messages"]))

    def test_buffers_switch(self):
        self.click("[data-tab='buffers']")
        image = self.js(MEAN)
        self.click("[data-buffer='depth']")
        self.wait(lambda: self.status().get("shown_buffer") == "depth")
        frames = self.js("return relume.state.frames")
        self.wait(lambda: self.js("return relume.state.frames") > frames + 5)  # some of the image may be under way
        self.assertNotAlmostEqual(self.js(MEAN), image, delta=1)
        self.click("[data-buffer='image']")
        self.wait(lambda: self.status().get("shown_buffer") == "")

    def test_a_press_outlasts_a_change_of_its_list(self):
        self.click("[data-tab='buffers']")
        page_test.ActionChains(self.browser).click_and_hold(self.one("[data-buffer='depth']")).perform()
        self.js("const v = relume.state.values; relume.link.emit('text', { ...v, buffers: [...v.buffers, { name: 'another', help: '' }] })")
        page_test.ActionChains(self.browser).release().perform()
        self.wait(lambda: self.status().get("shown_buffer") == "depth")
        self.click("[data-buffer='image']")
        self.wait(lambda: self.status().get("shown_buffer") == "")
        self.keep_page()

    def test_settings_are_those_of_the_program(self):
        names = self.js("return [...new Set([...document.querySelectorAll('[data-setting]')].map((e) => e.dataset.setting))]")
        self.assertEqual(sorted(names), sorted(json.loads(run("settings", "--json").stdout)))
        self.keep_page()

    def test_times_are_shown_by_pass(self):
        self.wait(lambda: self.js("return document.querySelectorAll('#passes tr').length") > 1)
        shown, told = self.js("return [[...document.querySelectorAll('#passes tr')].map((row) => [...row.children].map((cell) => cell.textContent)), relume.state.status.times[0].passes]")
        self.assertEqual([name for name, _ in shown], [each["name"] for each in told])
        for (_, text), each in zip(shown, told):
            self.assertAlmostEqual(float(text.removesuffix(" ms")), each["ms"], delta=0.006)
        self.assertGreater(sum(each["ms"] for each in told), 0)
        self.keep_page()

    def test_side_b_has_its_own_settings(self):
        self.click("[data-press='split']")
        self.wait(lambda: len(self.status()["times"]) == 2)
        self.js("relume.link.input({ do: 'set', side: 1, name: 'max-bounces', value: '0' })")

        def shows_emitters_only():
            left, right = self.js(MEANS_OF_HALVES)
            return right < 0.5 * left

        self.wait(shows_emitters_only)
        self.assertNotEqual(*(self.js("return relume.state.values.sides")[side]["max-bounces"] for side in (0, 1)))
        self.js("relume.link.input({ do: 'press', button: 'copy' })")
        self.click("[data-press='split']")
        self.wait(lambda: not self.one("#divider").is_displayed())
        self.keep_page()

    def test_sides_and_bookmarks(self):
        self.click("[data-press='split']")
        self.wait(lambda: self.one("#divider").is_displayed() and len(self.status()["times"]) == 2)
        self.click("[data-press='split']")
        self.wait(lambda: not self.one("#divider").is_displayed())
        self.click("[data-tab='camera']")
        before = len(self.status()["bookmarks"])
        eye = self.status()["eye"]
        page_test.ActionChains(self.browser).click(self.one("#camera > button")).perform()
        self.wait(lambda: len(self.status()["bookmarks"]) == before + 1)
        self.hold("s", 0.4)
        self.wait(lambda: self.status()["eye"] != eye)
        self.click(f"[data-bookmark='{before}']")
        self.wait(lambda: max(abs(a - b) for a, b in zip(self.status()["eye"], eye)) < 1e-3)
        self.keep_page()

    def test_a_screenshot_downloads(self):
        self.click("#screenshot")
        file = self.downloads / "relume-cornell.png"
        self.wait(file.exists)
        width, height, _, rows = png_pixels(file)
        self.assertGreaterEqual((width, height), (96, 54))
        self.assertGreater(max(map(max, rows)), 100)

    def test_a_refusal_shows_before_the_next_status(self):
        sentence = "a screenshot is in progress; wait for its download"
        shown = self.js("relume.link.emit('text', { kind: 'notice', text: arguments[0] }); return document.getElementById('messages').textContent", sentence)
        self.assertIn(sentence, shown)
        self.wait(lambda: sentence not in self.one("#messages").text)
        self.keep_page()

    def test_a_second_window_watches(self):
        first = self.browser.current_window_handle
        self.browser.switch_to.new_window("window")
        try:
            self.browser.get(self.server.address)
            self.wait(lambda: self.js("return Boolean(globalThis.relume && relume.state.frames > 0)"))
            self.assertTrue(self.js("return document.getElementById('settings').inert"))
            self.click("#steer")
            # On a busy machine, the first window may have been inactive for long enough to lose its role.
            self.wait(lambda: self.js("return relume.state.role.requests.length === 1 || relume.state.role.viewer === relume.state.role.steerer"))
            self.browser.switch_to.window(first)
            if self.js("return relume.state.role.viewer === relume.state.role.steerer"):
                self.wait(lambda: self.browser.find_elements(page_test.By.CSS_SELECTOR, "[data-grant]"))
                self.click("[data-grant]")
            self.wait(lambda: self.js("return relume.state.role.viewer !== relume.state.role.steerer"))
        finally:
            self.browser.switch_to.window(next(handle for handle in self.browser.window_handles if handle != first))
            self.browser.close()
            self.browser.switch_to.window(first)

    def test_rates(self):
        self.js("relume.link.latencies.length = 0")
        worst, received = float("inf"), float("inf")
        for key in ("w", "s", "w", "s") if QUIET else ("w", "s"):
            self.hold(key, 2 if QUIET else 1)
            rates = self.js("return relume.rates()")
            worst, received = min(worst, rates["drawn"]), min(received, rates["received"])
        latencies = sorted(self.js("return relume.link.latencies"))
        self.assertTrue(latencies)
        print(f"page: {worst} interface frames/s, {received} received/s at level {rates['level']}, latency from key to changed frame: median "
              f"{latencies[len(latencies) // 2]:.0f} ms, longest {latencies[-1]:.0f} ms", file=sys.stderr)
        self.assertGreater(received, 0)
        if QUIET:
            self.assertGreaterEqual(worst, 30)
            self.assertGreaterEqual(received, 24)
            self.assertLess(latencies[len(latencies) // 2], 200)
        self.keep_page()


if __name__ == "__main__":
    if not (page_test.webdriver and page_test.CHROMIUM and page_test.DRIVER):
        print("Chromium, its driver or selenium is missing; scripts/install_packages installs them")
        sys.exit(page_test.SKIPPED)
    unittest.main()
