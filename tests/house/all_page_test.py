#!/usr/bin/env python3
"""tools/all_page on a small made-up run: sorting, missing values, escaping, and the page of no run."""

import contextlib
import importlib.machinery
import importlib.util
import io
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

import house

sys.dont_write_bytecode = True


def load():
    loader = importlib.machinery.SourceFileLoader("all_page", str(house.ROOT / "tools/all_page"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("all_page", loader))
    loader.exec_module(module)
    return module


all_page = load()
SLOTS = ("lights", "cache", "denoise")


def technique(name, mse=None, **more):
    values = {"name": name, "settings": "", "slots": {**dict.fromkeys(SLOTS, "none"), **more.pop("slots", {})}}
    if mse is not None:
        values |= {"mse": mse, "mse_low": 0.9 * mse, "mse_high": 1.1 * mse, "flip": 0.1, "frame_ms": 20.0, "time_s": 0.51, "rays": 4.0, "memory_bytes": 2_500_000,
                   "bias2": 0.001, "bias2_error": 0.01, "variance": mse, "keeps_state": False, "image": f"images/a/{name}.jpg"}  # fmt: skip
    return values | more


def survey():
    scenes = [
        {"name": "a|b", "change": "the camera turns by 15°", "seconds": 300, "mean_square": 0.5, "reference_mse": 1e-6, "reference_spp": 512, "reference_settings": "lights:light-tree",
         "image": "images/a/reference.jpg", "techniques": [
             technique("path", 0.04),
             technique("cache=sharc", 0.02, keeps_state=True, lag=None, ghost=0.01, ghost_error=0.001, bias2=0.005, bias2_error=0.001, slots={"cache": "sharc"}),
             technique("denoise=oidn", refused="needs </script><b> | x", slots={"denoise": "oidn"}),
             technique("lights=vlc", 0.03, keeps_state=True, lag=3, ghost=0.0001, ghost_error=0.001, slots={"lights": "vlc"}),
             technique("strange=new", -0.001)]},
        {"name": "c", "change": "1 s passes", "seconds": None, "mean_square": 0.5, "reference_mse": 1e-6, "reference_spp": 512, "reference_settings": "lights:light-tree",
         "techniques": [technique("path", 0.01), technique("cache=sharc", 0.02, slots={"cache": "sharc"})]},
    ]  # fmt: skip
    return {"quick": False, "machine": {"Processor": "P"}, "scenes": scenes,
            "setup": {"size": "192 × 108", "budget_s": 0.5, "repetitions": 4, "runs": 3, "warm_up": 12, "frames": 16, "ghost_frame": 4}}  # fmt: skip


def table_rows(text, heading):
    """Cells of the rows of the table below a heading."""
    part = text.split(f"\n{heading}\n", 1)[1].split("\n#", 1)[0]
    lines = [line for line in part.splitlines() if line.startswith("|")][2:]
    return [[c.strip() for c in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]


class Markdown(unittest.TestCase):
    def setUp(self):
        self.text = all_page.page(survey())

    def test_scenes_are_sorted_by_error_and_missing_values_come_last(self):
        rows = table_rows(self.text, r"### a\|b")
        self.assertEqual([re.sub(r"\[|\]\(.*?\)", "", row[0]) for row in rows], ["strange=new", "cache=sharc", "lights=vlc", "path", "denoise=oidn"])
        self.assertEqual(set(rows[-1][1:]), {"–"})
        self.assertEqual({len(row) for row in rows}, {11})

    def test_values(self):
        rows = {row[0].split("]")[0].strip("["): row for row in table_rows(self.text, r"### a\|b")}
        self.assertEqual(rows["cache=sharc"][1:], ["0.02 (0.018 to 0.022)", "0.5", "0.1", "5.00e-03", "> 16", "2", "4", "20", "0.51", "2.5"])
        self.assertEqual(rows["lights=vlc"][4:7], ["≈ 0", "3", "≈ 0"])
        self.assertEqual(rows["path"][2], "1")
        self.assertEqual(rows["path"][5:7], ["–", "–"])  # has no state
        self.assertEqual(rows["strange=new"][2], "–")  # below the reference's noise

    def test_failures_are_cells(self):
        run = survey()
        run["scenes"][0]["techniques"] += [technique("late=still", failed="no | memory"), technique("late=change", 0.05, failed="the device is gone")]
        rows = {row[0]: row[1:] for row in table_rows(all_page.page(run), r"### a\|b")}
        self.assertEqual(rows["late=still"], [r"failed: no \| memory", *["–"] * 9])
        self.assertEqual(rows["late=change"][:2], ["0.05 (0.045 to 0.055)", "1.25"])
        self.assertEqual(rows["late=change"][4:6], ["failed: the device is gone", "–"])

    def test_overview_is_a_geometric_mean(self):
        rows = table_rows(self.text, "## Over all scenes")
        self.assertEqual([row[1:] for row in rows], [["1", "2"], ["1", "2"], ["0.75", "1"], ["–", "0"], ["–", "0"]])

    def test_text_is_escaped(self):
        self.assertIn(r"| denoise=oidn | a\|b | needs &lt;/script>&lt;b> \| x |", self.text)
        self.assertNotIn("</script>", self.text)

    def test_links_lead_to_pages_of_techniques(self):
        links = re.findall(r"\]\((\.\./\.\./src/[^)]+)\)", self.text)
        self.assertGreater(len(links), 3)
        for link in links:
            self.assertTrue((house.ROOT / "docs/results" / link).exists(), link)
        self.assertEqual(all_page.linked("strange=new"), "strange=new")
        for name in all_page.FOLDERS:
            self.assertIsNotNone(all_page.page_of(name), name)
        self.assertEqual(all_page.page_of("restir-gi"), "reuse/restir_gi/README.md")

    def test_numbers(self):
        self.assertEqual([all_page.short(x) for x in (None, 0, 0.01234, 0.001, 999.9, 12345, -2.5)], ["–", "0", "0.0123", "1.00e-03", "1000", "1.23e+04", "-2.5"])


class Files(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def run_tool(self, *arguments):
        output = io.StringIO()
        paths = {"ROOT": self.folder, "PAGE": self.folder / "all.md", "STORED": self.folder / "stored.json"}
        with mock.patch.multiple(all_page, **paths), mock.patch.object(sys, "argv", ["all_page", *map(str, arguments)]), contextlib.redirect_stdout(output):
            return all_page.main(), output.getvalue()

    def write(self, run):
        (self.folder / "all.json").write_text(json.dumps(run), encoding="utf-8")

    def test_without_a_run_the_page_says_so(self):
        self.assertEqual(self.run_tool(), (0, "No run is stored yet.\n"))
        text = (self.folder / "all.md").read_text()
        self.assertIn("No run is stored yet.", text)
        self.assertEqual(re.findall(r"^\|", text, re.MULTILINE), [])
        self.assertEqual(self.run_tool("--check")[0], 0)
        with self.assertRaisesRegex(SystemExit, "no run is stored"):
            self.run_tool("--html", self.folder / "all.html", "--from", self.folder)
        self.assertFalse((self.folder / "all.html").exists())

    def test_stores_a_run(self):
        self.write(survey())
        self.assertEqual(self.run_tool("--store", self.folder)[0], 0)
        self.assertIn("## Over all scenes", (self.folder / "all.md").read_text())
        self.assertEqual(self.run_tool("--check")[0], 0)
        (self.folder / "all.md").write_text("old")
        self.assertEqual(self.run_tool("--check")[0], 1)

    def test_refuses_quick_runs(self):
        self.write(survey() | {"quick": True})
        for arguments in (("--store", self.folder), ("--html", self.folder / "all.html", "--from", self.folder)):
            with self.assertRaisesRegex(SystemExit, "--quick"):
                self.run_tool(*arguments)

    def test_html_holds_everything(self):
        self.write(survey())
        (self.folder / "images/a").mkdir(parents=True)
        (self.folder / "images/a/path.jpg").write_bytes(b"\xff\xd8jpeg")
        self.assertEqual(self.run_tool("--html", self.folder / "all.html", "--from", self.folder)[0], 0)
        text = (self.folder / "all.html").read_text(encoding="utf-8")
        self.assertEqual(text.count("</script>"), 2)
        self.assertNotIn("@@", text)
        self.assertIsNone(re.search(r"(?:src|href)=|https?://|@import", text))
        data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)[1])
        scene = data["scenes"][0]
        self.assertEqual(scene["techniques"][2]["refused"], "needs </script><b> | x")
        self.assertTrue(scene["techniques"][0]["image"].startswith("data:image/jpeg;base64,"))
        self.assertIsNone(scene["techniques"][1]["image"])  # not in the folder
        self.assertIsNone(scene["image_after"])


@unittest.skipUnless(shutil.which("node"), "no node")
class Script(unittest.TestCase):
    def evaluate(self, code):
        program = f"const s = require({json.dumps(str(all_page.PARTS / 'page.js'))}); const data = {json.dumps(survey())}; const rows = s.rows(data);"
        done = subprocess.run(["node", "-e", f"{program} console.log(JSON.stringify({code}))"], capture_output=True, text=True, check=True)
        return json.loads(done.stdout)

    def names(self, code):
        return self.evaluate(f"({code}).map((r) => r.technique.name + ' ' + r.scene.name)")

    def test_missing_values_come_last_in_both_directions(self):
        scene = "s.filtered(rows, { scene: 'a|b', slots: {} })"
        up = self.names(f"s.sorted({scene}, 2, false)")
        self.assertEqual([name.split()[0] for name in up], ["strange=new", "cache=sharc", "lights=vlc", "path", "denoise=oidn"])
        down = self.names(f"s.sorted({scene}, 2, true)")
        self.assertEqual(down, [*up[3::-1], up[4]])

    def test_filters_by_scene_and_slot(self):
        self.assertEqual(self.names("s.filtered(rows, { scene: '', slots: { cache: 'sharc', lights: '' } })"), ["cache=sharc a|b", "cache=sharc c"])
        self.assertEqual(self.evaluate("s.choices(data)"), {"lights": ["none", "vlc"], "cache": ["none", "sharc"], "denoise": ["none", "oidn"]})

    def test_texts_agree_with_the_markdown_page(self):
        self.assertEqual(self.evaluate("[undefined, 0, 0.01234, 0.001, 999.9, 12345, -2.5].map(s.format)"), ["–", "0", "0.0123", "1.00e-3", "1000", "1.23e+4", "-2.5"])
        self.assertEqual(self.evaluate("rows.slice(0, 4).map(s.lagText)"), ["–", "> 16", "–", "3"])
        failed = "{ technique: { failed: 'no memory' } }"
        late = "{ technique: { failed: 'no memory', mse: 0.02 } }"
        self.assertEqual(self.evaluate(f"[s.columns[2].text({failed}), s.lagText({failed}), s.columns[2].text({late}), s.lagText({late})]"),
                         ["failed: no memory", "–", "0.02", "failed: no memory"])  # fmt: skip
        self.assertEqual(self.evaluate("s.columns.map((c) => (c.text ? c.text(rows[1]) : s.format(c.value(rows[1]))))"),
                         ["a|b", "cache=sharc", "0.02", "0.5", "–", "0.1", "5.00e-3", "0.02", "> 16", "2", "4", "20", "0.51", "2.5"])  # fmt: skip


if __name__ == "__main__":
    unittest.main()
