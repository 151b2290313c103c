#!/usr/bin/env python3
"""scripts/docs builds a site with all pages and images, a search and nothing from the net; broken pages fail the build."""

import pathlib
import re
import sys
import tempfile
import unittest

import house

sys.dont_write_bytecode = True
sys.path.insert(0, str(house.ROOT / "tools/site"))
import build  # noqa: E402

NEEDED = re.compile(r"<(?:img|script|link|iframe|source)\b[^>]*?\b(?:src|href)=\"([^\"#?]+)|url\(\"?([^)\"]+)|@import \"([^\"]+)")
LINKED = re.compile(r"<a\b[^>]*?\bhref=\"([^\"#?:]+)(?:#[^\"]*)?\"")


class Site(unittest.TestCase):
    """The site of this repository."""

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.out = pathlib.Path(scratch.name) / "site"
        build.build(house.ROOT, pathlib.Path(scratch.name), cls.out)

    def pages(self):
        return sorted(self.out.rglob("*.html"))

    def test_has_every_page(self):
        pages = {page.relative_to(house.ROOT).as_posix() for page in house.files(house.ROOT) if page.suffix == ".md"}
        staged = {page.relative_to(house.ROOT).as_posix(): name for page, name in build.site_names(house.ROOT).items()}
        self.assertEqual(pages, set(staged))
        for name in staged.values():
            self.assertTrue((self.out / name).with_suffix(".html").exists(), name)

    def test_every_page_is_in_the_navigation(self):
        start = (self.out / "index.html").read_text(encoding="utf-8")
        linked = set(LINKED.findall(start))
        for page in self.out.glob("*.html"):
            if page.name not in ("index.html", "search.html"):
                self.assertIn(page.name, linked)
        self.assertIn("techniques/denoise.html", linked)

    def test_files_are_there_and_nothing_is_from_the_net(self):
        for page in [*self.pages(), *self.out.rglob("*.css")]:
            for groups in NEEDED.findall(page.read_text(encoding="utf-8")):
                target = "".join(groups)
                self.assertNotRegex(target, "^(?:[a-z]+:)?//", page.name)
                if not target.startswith("data:"):
                    self.assertTrue((page.parent / target).exists(), f"{page.name}: {target}")

    def test_links_lead_to_pages(self):
        for page in self.pages():
            for target in LINKED.findall(page.read_text(encoding="utf-8")):
                self.assertTrue((page.parent / target).exists(), f"{page.name}: {target}")

    def test_search_finds_words(self):
        index = (self.out / "searchindex.js").read_text(encoding="utf-8")
        self.assertIn("roulett", index)
        self.assertIn("techniques/transport/path", index)

    def test_colours_follow_the_system(self):
        self.assertIn("prefers-color-scheme: dark", (self.out / "_static/site.css").read_text(encoding="utf-8"))


class Broken(unittest.TestCase):
    """Scratch repositories."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = pathlib.Path(scratch.name)
        self.write("README.md", "# Start\n\n[page](docs/page.md#a-heading), `[code](lost.md)`\n")
        self.write("docs/README.md", "# All pages\n\n**Start**\n\n| page |\n|---|\n| [page](page.md) |\n")
        self.write("docs/page.md", "# Page\n\n## A heading\n\n[file](../src/a.h), [`a.h`](../src/a.h), [start](../README.md), {role}`a` [Key01]\n")
        self.write("src/a.h", "")

    def write(self, name, text):
        (self.root / name).parent.mkdir(parents=True, exist_ok=True)
        (self.root / name).write_text(text, encoding="utf-8")

    def build(self):
        build.build(self.root, self.root / "work", self.root / "site")

    def assert_breaks(self, part):
        with self.assertRaises(build.Broken) as broken:
            self.build()
        self.assertIn(part, str(broken.exception))

    def test_links(self):
        self.build()
        page = (self.root / "work/source/page.md").read_text(encoding="utf-8")
        self.assertIn("file (`src/a.h`), `a.h`, [start](index.md), {role}`a` [Key01]", page)
        self.assertIn('href="page.html#a-heading"', (self.root / "site/index.html").read_text(encoding="utf-8"))

    def test_dead_link(self):
        self.write("docs/page.md", "# Page\n\n[lost](lost.md)\n")
        self.assert_breaks("docs/page.md:3: the link to lost.md has no target")

    def test_dead_image(self):
        self.write("docs/page.md", "# Page\n\n![lost](lost.png)\n")
        self.assert_breaks("docs/page.md:3: the link to lost.png has no target")

    def test_dead_anchor(self):
        self.write("docs/page.md", "# Page\n\n## Another heading\n")
        self.assert_breaks("a-heading")

    def test_page_outside_the_navigation(self):
        self.write("docs/other.md", "# Other\n")
        self.assert_breaks("docs/other.md: docs/README.md does not list this page")


if __name__ == "__main__":
    if build.python_with_sphinx() is None:
        print("Sphinx or MyST is missing; scripts/install_packages docs installs them")
        sys.exit(77)
    unittest.main()
