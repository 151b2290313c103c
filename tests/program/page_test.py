#!/usr/bin/env python3
"""Tests pages of comparisons and experiments in a browser: every control, by mouse and keyboard. Needs Chromium and
selenium."""

import json
import os
import pathlib
import shutil
import sys
import tempfile
import unittest

from program import run

SYSTEM_PYTHON = "/usr/bin/python3"

try:
    from selenium import webdriver
    from selenium.common.exceptions import StaleElementReferenceException as Stale
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:
    webdriver = None
    if os.path.exists(SYSTEM_PYTHON) and sys.executable != SYSTEM_PYTHON:  # the interpreter of Debian's selenium package
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, *sys.argv])

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
DRIVER = shutil.which("chromedriver")
SKIPPED = 77  # ctest's exit code for skipped tests
POLL_S = 0.05


def start_browser(resolver_rules="MAP * ~NOTFOUND", preferences=None):
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1400,1000", f"--host-resolver-rules={resolver_rules}"):
        options.add_argument(argument)
    options.add_experimental_option("prefs", preferences or {})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(DRIVER), options=options)


class Page(unittest.TestCase):
    """Opens the page PAGE, made by the command ARGUMENTS, before each test."""

    ARGUMENTS = []
    PAGE = ""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="relume_")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        done = run(*cls.ARGUMENTS, "-o", "out", "--cache-dir", "cache", cwd=cls.folder, timeout=600)
        assert done.returncode == 0, done.stderr
        cls.browser = start_browser()
        cls.addClassCleanup(cls.browser.quit)

    def setUp(self):
        self.browser.get((self.folder / "out" / self.PAGE).as_uri())
        self.browser.execute_script("localStorage.clear()")
        self.wait(lambda: self.browser.execute_script("return document.documentElement.hasAttribute('data-ready')"))

    def read(self, name):
        return (self.folder / "out" / name).read_text(encoding="utf-8")

    def wait(self, condition):
        WebDriverWait(self.browser, 20, POLL_S).until(lambda _: condition())

    def all(self, selector):
        return self.browser.find_elements(By.CSS_SELECTOR, selector)

    def one(self, selector):
        return self.browser.find_element(By.CSS_SELECTOR, selector)

    def click(self, selector):
        element = self.one(selector)
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", element)
        element.click()

    def visible_panes(self):
        return [pane.get_attribute("data-pane") for pane in self.all(".pane") if pane.is_displayed()]

    def pixels(self, selector=".pane canvas"):
        """Sum of a canvas's bytes after the next frame."""
        return self.browser.execute_async_script(
            "const done = arguments[1]; requestAnimationFrame(() => requestAnimationFrame(() => {"
            "const c = [...document.querySelectorAll(arguments[0])].find((e) => e.offsetParent);"
            "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let s = 0; for (let i = 0; i < d.length; ++i) s = (s * 31 + d[i]) % 1000003; done(s); }))", selector)

    def keys(self, *keys):
        ActionChains(self.browser).send_keys(*keys).perform()

    def severe_messages(self):
        return [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"]


class ComparePage(Page):
    ARGUMENTS = [
        "compare", "cornell", "--width", "64", "--height", "48", "--max-bounces", "3", "--spp", "32", "--repeat", "4",
        "--techniques", "uniform=lights:uniform", "--techniques", "short=max-bounces:1", "--reference-spp", "64",
        "--psf.cell-size", "12", "--guide", "bsdf"]
    PAGE = "compare.html"

    def zoom(self):
        self.pixels()
        return self.one(".viewer-block output").text

    def test_files_and_numbers(self):
        self.assertEqual(sorted(p.name for p in (self.folder / "out").iterdir()), ["compare.csv", "compare.html", "compare.json"])
        numbers = json.loads(self.read("compare.json"))
        self.assertEqual([c["name"] for c in numbers["contenders"]], ["uniform", "short"])
        first, second = numbers["contenders"]
        self.assertGreater(first["mse"]["median"], 0)
        self.assertEqual(first["samples_per_pixel"]["median"], 32)
        self.assertGreater(second["bias2"], first["bias2"])
        self.assertGreater(second["bias2"], 2 * second["bias2_error"])
        self.assertEqual([c["nonfinite_pixels"] for c in numbers["contenders"]], [0, 0])
        self.assertGreater(numbers["reference"]["mse"], 0)
        self.assertEqual(numbers["reference"]["flags_left_out"], {"psf.cell-size": "12"})
        header, *rows = self.read("compare.csv").splitlines()
        self.assertEqual(len(rows), 2)
        self.assertEqual(len(header.split(",")), len(rows[0].split(",")))

    def test_opens_without_errors_and_without_a_network(self):
        self.assertEqual(self.severe_messages(), [])
        self.assertEqual(self.browser.execute_script("return performance.getEntriesByType('resource').filter((e) => !e.name.startsWith('data:')).length"), 0)
        self.assertEqual(self.visible_panes(), ["reference", "uniform", "short"])
        self.assertEqual(len(self.all("section")), 6)

    def test_lists_settings_not_used_for_the_reference(self):
        pairs = [row.text for row in self.all(".details-block tbody tr")]
        self.assertIn("Not for the reference psf.cell-size = 12", [" ".join(pair.split()) for pair in pairs])

    def test_keys_flip_through_the_images(self):
        self.one(".viewer").click()
        shown = []
        for key, name in (("1", "reference"), ("2", "uniform"), ("3", "short")):
            self.keys(key)
            self.assertEqual(self.visible_panes(), [name])
            shown.append(self.pixels())
        self.assertEqual(len(set(shown)), 3)
        self.keys("9")  # no such pane
        self.assertEqual(self.visible_panes(), ["short"])
        self.one(".viewer").send_keys(" ")
        self.assertEqual(self.visible_panes(), ["uniform"])
        self.keys("g")
        self.assertEqual(len(self.visible_panes()), 3)

    def test_layout_and_image_buttons(self):
        self.click("[data-choice='In place']")
        self.assertEqual(self.visible_panes(), ["reference"])
        self.click("[data-image='short']")
        self.assertEqual(self.visible_panes(), ["short"])
        self.assertEqual(self.one("[data-image='short']").get_attribute("aria-pressed"), "true")
        self.click("[data-choice='Side by side']")
        self.assertEqual(len(self.visible_panes()), 3)

    def test_maps(self):
        self.one(".viewer").click()
        self.keys("2")
        seen = {self.pixels()}
        for layer in ("Difference", "relMSE", "FLIP"):
            self.click(f"[data-choice='{layer}']")
            self.wait(lambda: self.pixels() not in seen)
            seen.add(self.pixels())
            self.assertTrue(self.one(".ramp i").is_displayed())
        self.keys("m")
        self.assertEqual(self.one("[data-choice='Image']").get_attribute("aria-pressed"), "true")
        self.assertEqual(self.all(".ramp i"), [])

    def test_zoom_and_pan_move_all_images(self):
        fitted = self.zoom()
        before = self.pixels()
        self.click("[data-action='Zoom in']")
        self.assertNotEqual(self.zoom(), fitted)
        self.click("[data-action='Zoom out']")
        self.assertEqual(self.zoom(), fitted)
        self.click("[data-action='One to one']")
        self.assertEqual(self.zoom(), "100 %")
        self.click("[data-action='Fit']")
        self.assertEqual(self.zoom(), fitted)
        self.one(".viewer").send_keys("+")
        self.assertNotEqual(self.zoom(), fitted)
        moved = self.pixels()
        self.one(".viewer").send_keys(Keys.ARROW_LEFT)
        self.assertNotEqual(self.pixels(), moved)
        self.keys("f")
        self.assertEqual(self.zoom(), fitted)
        canvases = self.all(".pane canvas")
        ActionChains(self.browser).scroll_from_origin(webdriver.common.actions.wheel_input.ScrollOrigin.from_element(canvases[1]), 0, -400).perform()
        self.assertNotEqual(self.zoom(), fitted)
        zoomed = self.pixels()
        ActionChains(self.browser).drag_and_drop_by_offset(canvases[2], 40, 25).perform()
        self.assertNotEqual(self.pixels(), zoomed)  # of the first image; the third was dragged
        self.click("[data-action='Fit']")
        self.wait(lambda: self.zoom() == fitted)
        self.one(".viewer").send_keys(Keys.ENTER, Keys.ENTER)  # pins the pixel under the mouse, and releases it
        self.wait(lambda: self.pixels() == before)

    def test_values_under_the_cursor(self):
        canvas = self.all(".pane canvas")[1]
        ActionChains(self.browser).move_to_element(canvas).perform()
        self.wait(lambda: self.all("[data-pixel]"))
        self.assertRegex(self.one("[data-pixel]").get_attribute("data-pixel"), r"^3[12],2[34]$")
        self.wait(lambda: "…" not in self.one(".inspector").text)
        self.assertEqual(len(self.all(".inspector tbody tr")), 3)
        values = self.one(".inspector tbody tr").text.split()
        self.assertEqual(values[0], "reference")
        self.assertGreater(float(values[1]), 0)
        canvas.click()
        self.assertIn("held", self.one("[data-pixel]").text)
        held = self.one("[data-pixel]").get_attribute("data-pixel")
        ActionChains(self.browser).move_to_element_with_offset(canvas, 30, 20).perform()
        self.assertEqual(self.one("[data-pixel]").get_attribute("data-pixel"), held)
        self.one(".viewer").send_keys(Keys.ENTER)
        self.assertEqual(self.all("[data-pixel]"), [])
        self.one(".viewer").send_keys(Keys.ENTER)
        self.assertEqual(self.one("[data-pixel]").get_attribute("data-pixel"), "32,24")

    def test_crops(self):
        count = len(self.all(".crop"))
        self.assertGreaterEqual(count, 2)
        fitted = self.zoom()
        self.click(".crop button.shot")
        self.wait(lambda: self.zoom() != fitted)
        self.click("[data-action='Add crop']")
        self.assertEqual(len(self.all(".crop")), count + 1)

    def test_all_columns_show_at_1200_pixels(self):
        self.browser.set_window_size(1200, 900)
        self.addCleanup(self.browser.set_window_size, 1400, 1000)
        hidden = "const s = document.querySelector('.table-block .scroll'); return s.scrollWidth - s.clientWidth"
        self.wait(lambda: self.browser.execute_script(hidden) <= 0)

    def test_many_passes_have_many_colours(self):
        for count in (1, 9, 10, 16, 24, 30):
            colors = self.browser.execute_script("return relume.distinctColors(arguments[0])", count)
            self.assertEqual(len(set(colors)), count)
        shown = [rect.value_of_css_property("fill") for rect in self.all(".bars rect[data-part]")]
        names = [rect.get_attribute("data-part") for rect in self.all(".bars rect[data-part]")]
        self.assertEqual(len(set(zip(names, shown))), len(set(names)))
        self.assertEqual(len(set(shown)), len(set(names)))

    def test_table_sorts(self):
        names = lambda: [row.text.split("\n")[0].split(" ")[0] for row in self.all(".table-block tbody tr")]
        self.assertEqual(names(), ["uniform", "short", "reference"])
        self.click(".table-block thead th:nth-child(2) button")
        first = names()
        self.assertEqual(self.one(".table-block thead th:nth-child(2)").get_attribute("aria-sort"), "ascending")
        self.click(".table-block thead th:nth-child(2) button")
        self.assertNotEqual(names(), first)
        self.assertTrue(self.all("td.best"))

    def test_curves(self):
        self.assertEqual(len(self.all(".chart-block g[data-curve]")), 3)
        labels = set()
        for choice in ("relMSE by samples", "MSE by time", "MSE by samples", "relMSE by time"):
            self.click(f"[data-choice='{choice}']")
            labels.add(tuple(e.text for e in self.all(".chart-block .axis .label")))
        self.assertEqual(len(labels), 4)
        self.click(".chart-block .legend button")
        self.assertEqual(len(self.all(".chart-block g[data-curve]")), 2)
        self.click(".chart-block .legend button")
        ActionChains(self.browser).move_to_element(self.one(".chart-block svg")).perform()
        self.assertTrue(self.one(".chart-block .tip").is_displayed())
        self.click(".chart-block summary")
        self.wait(lambda: len(self.all(".chart-block details tbody tr")) > 6)  # filled after the browser reports it open

    def test_frame_times(self):
        self.assertGreaterEqual(len(self.all(".bars rect[data-part]")), 4)
        self.click(".bars-block summary")
        self.assertEqual(len(self.all(".bars-block tbody tr")), 2)

    def test_light_and_dark(self):
        ground = lambda: self.browser.execute_script("return getComputedStyle(document.body).backgroundColor")
        self.click("[data-theme-choice='light']")
        light = ground()
        self.click("[data-theme-choice='dark']")
        dark = ground()
        self.assertNotEqual(light, dark)
        self.click("[data-theme-choice='auto']")
        for scheme, expected in (("dark", dark), ("light", light)):
            self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
            self.assertEqual(ground(), expected)

    def test_every_control_has_a_name_and_can_be_reached_by_keyboard(self):
        unnamed = self.browser.execute_script(
            "return [...document.querySelectorAll('button, select, [role=img], [tabindex=\"0\"]')]"
            ".filter((e) => !(e.getAttribute('aria-label') || e.textContent.trim())).map((e) => e.outerHTML.slice(0, 80))")
        self.assertEqual(unnamed, [])
        unreachable = self.browser.execute_script("return [...document.querySelectorAll('button, select, summary, a[href]')].filter((e) => e.tabIndex < 0).length")
        self.assertEqual(unreachable, 0)
        self.browser.execute_script("document.activeElement.blur()")
        self.keys(Keys.TAB)
        self.assertEqual(self.browser.execute_script("return document.activeElement.className"), "skip")


class ExperimentPage(Page):
    ARGUMENTS = ["experiment", "run", "combination", "adaptive-sampling", "--quick"]
    PAGE = "combination.html"

    def test_claims_stand_beside_curves(self):
        self.assertEqual(self.severe_messages(), [])
        result = json.loads(self.read("combination.json"))
        self.assertTrue(result["quick"])
        self.assertTrue(result["curves"])
        for claim in result["claims"]:
            self.assertEqual(set(claim), {"id", "paper", "claim", "measured", "threshold", "verdict"})
            row = self.one(f"[data-claim='{claim['id']}']")
            self.assertIn(claim["measured"].replace("`", ""), row.text)
            self.assertNotIn("`", row.text)
            self.assertEqual(row.find_element(By.CSS_SELECTOR, ".verdict").text, claim["verdict"])
        self.assertEqual({claim["verdict"] for claim in result["claims"] if "sponza" in claim["id"]}, {"not measured"})
        self.click("[data-choice='by frames']")
        self.assertGreaterEqual(len(self.all("g[data-curve]")), 4)

    def test_images_of_every_scene_can_be_chosen(self):
        self.assertIn("combination, min/max 4/32, map", self.visible_panes())
        self.browser.get((self.folder / "out" / "adaptive-sampling.html").as_uri())
        choice = Select(self.one("[data-action='view']"))
        self.assertEqual([option.text for option in choice.options], ["closed box", "directional light", "highly reflective"])
        before = self.pixels()
        choice.select_by_index(2)
        self.wait(lambda: self.pixels() != before)
        self.assertEqual(len(self.visible_panes()), 7)  # reference, four techniques, two maps

    def test_continue_skips_completed_pages(self):
        before = self.read("combination.json")
        done = run(*self.ARGUMENTS, "--continue", "-o", "out", "--cache-dir", "cache", cwd=self.folder, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("already", done.stderr)
        self.assertEqual(self.read("combination.json"), before)

    def test_the_index_leads_to_each(self):
        self.browser.get((self.folder / "out" / "index.html").as_uri())
        self.assertEqual([link.get_attribute("href").rsplit("/", 1)[1] for link in self.all(".links-block a")], ["adaptive-sampling.html", "combination.html"])
        self.click(".links-block a")
        self.wait(lambda: "adaptive-sampling.html" in self.browser.current_url)


if __name__ == "__main__":
    if not (webdriver and CHROMIUM and DRIVER):
        print("Chromium, its driver or selenium is missing; scripts/install_packages installs them")
        sys.exit(SKIPPED)
    unittest.main()
