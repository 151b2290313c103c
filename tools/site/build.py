#!/usr/bin/env python3
"""tools/site/build.py OUT: builds the documentation into OUT, as HTML pages with search.

Copies the pages and their images to build/docs/source and rewrites their links; docs/README.md defines the navigation.
Links to source files become plain text with the path in the repository. Dead links, pages outside the navigation and
warnings of Sphinx fail the build. Needs Sphinx and MyST, which scripts/docs installs.
"""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SITE = pathlib.Path(__file__).resolve().parent
MODULES = "sphinx, myst_parser"

# Pages outside docs/ and the techniques' folders -> their names on the site.
OTHER_PAGES = {
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "bench/README.md": "benchmarks.md",
    "examples/README.md": "examples.md",
    "tests/README.md": "tests.md",
    "tests/scene_formats/README.md": "scene-formats-tests.md",
    "lab/experiments/README.md": "experiments.md",
    "docs/README.md": "all-pages.md",
}
# Folders of techniques, in the order of a frame -> their headings.
GROUPS = {
    "gbuffer": "G-buffer",
    "transport": "Light transport",
    "light_sampling": "Light sampling",
    "guiding": "Path guiding",
    "spatial": "Spatial structures",
    "radiance_cache": "Radiance caches",
    "temporal": "Temporal accumulation and adaptive sampling",
    "denoise": "Denoising",
}
TECHNIQUES_BEFORE = "Measuring"  # the section of the navigation that follows the techniques

IMAGES = (".jpg", ".png", ".svg", ".webp")
CODE = re.compile(r"^```.*?^```[ \t]*$|`[^`\n]*`", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(?<!\\)(?P<image>!?)\[(?P<text>(?:[^\[\]]|\[[^\]]*\])*)\]\((?P<target>[^()\s]+)\)")
SECTION = re.compile(r"^\*\*(.+?)\*\*$|^\| \[.*?\]\((\S+?)\)", re.MULTILINE)


class Broken(Exception):
    """A page is invalid; the message tells its author why."""


def site_names(root):
    """Page -> its name on the site, of every page of the repository."""
    names = {root / page: name for page, name in OTHER_PAGES.items() if (root / page).exists()}
    for page in sorted((root / "docs").rglob("*.md")):
        names.setdefault(page, page.relative_to(root / "docs").as_posix())
    for page in sorted((root / "src/techniques").glob("*/*/README.md")):
        names[page] = f"techniques/{page.parent.parent.name}/{page.parent.name}.md"
    return names


def image_name(root, image):
    """An image's name on the site."""
    folder = image.parent.relative_to(root)
    if folder.parts[:1] == ("docs",):
        return image.relative_to(root / "docs").as_posix()
    return "/".join((*folder.parts[1:], image.name))


def as_text(text, path):
    """A link to a file of the repository: its text, and the path unless the text is the file's name."""
    bare = text.strip("`")
    if bare in (path, path.rsplit("/", 1)[-1]):
        return f"`{bare}`"
    return f"{text} (`{path}`)"


class Stage:
    """Copies the pages with links of the site."""

    def __init__(self, root, out):
        self.root, self.out = root, out
        self.names = site_names(root)
        self.images = {}
        self.problems = []

    def rewritten(self, page):
        """A page's text with the site's links."""
        text = page.read_text(encoding="utf-8")
        masked = CODE.sub(lambda m: re.sub(r"[^\n]", "x", m[0]), text)
        parts, end = [], 0
        for match in LINK.finditer(masked):
            parts += [text[end:match.start()], self.link(page, match["image"], text[slice(*match.span("text"))], match["target"])]
            if parts[-1] is None:
                line = text.count("\n", 0, match.start()) + 1
                self.problems.append(f"{page.relative_to(self.root)}:{line}: the link to {match['target']} has no target")
                parts.pop()
            end = match.end()
        return "".join(parts) + text[end:]

    def link(self, page, image, text, target):
        """The site's form of a link; None if it has no target."""
        if re.match(r"[a-z]+:|#", target):
            return f"{image}[{text}]({target})"
        target, _, anchor = target.partition("#")
        file = pathlib.Path(os.path.normpath(page.parent / target))
        if not file.exists() or self.root not in (file, *file.parents):
            return None
        if file / "README.md" in self.names:
            file /= "README.md"
        name = self.names.get(file)
        if name is None and file.suffix in IMAGES:
            name = self.images[file] = image_name(self.root, file)
        if name is None:
            return as_text(text, file.relative_to(self.root).as_posix())
        relative = os.path.relpath(name, pathlib.PurePosixPath(self.names[page]).parent)
        return f"{image}[{text}]({relative}{'#' if anchor else ''}{anchor})"

    def write(self, name, text):
        file = self.out / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def sections(self):
        """(heading, names of pages) of the navigation, as docs/README.md groups them."""
        index = self.root / "docs/README.md"
        found = []
        for heading, target in SECTION.findall(index.read_text(encoding="utf-8")):
            if heading:
                found.append((heading, []))
            elif found:
                page = pathlib.Path(os.path.normpath(index.parent / target))
                found[-1][1].append(self.names.get(page, target))
        return found

    def groups(self):
        """Writes a page for each group of techniques; their names."""
        written = []
        present = {page.parent.parent.name for page, name in self.names.items() if name.startswith("techniques/")}
        for group in [*(g for g in GROUPS if g in present), *sorted(present - GROUPS.keys())]:
            heading = GROUPS.get(group, group.replace("_", " ").capitalize())
            members = [f"{group}/{name.rsplit('/', 1)[-1]}" for name in self.names.values() if name.startswith(f"techniques/{group}/")]
            self.write(f"techniques/{group}.md", f"# {heading}\n\n{toctree(members)}")
            written.append(f"techniques/{group}.md")
        return written

    def navigation(self):
        """The start page's navigation; checks that every page is in it."""
        trees = []
        listed = {"index.md"}
        groups = self.groups()
        for heading, pages in self.sections():
            if heading == TECHNIQUES_BEFORE:
                trees.append(toctree(groups, "Techniques"))
            if heading == self.sections()[-1][0]:
                pages = [*pages, "all-pages.md"]
            trees.append(toctree(pages, heading))
            listed.update(pages)
        for page, name in self.names.items():
            if name not in listed and not name.startswith(("techniques/", "results/")):
                self.problems.append(f"{page.relative_to(self.root)}: docs/README.md does not list this page")
        return "\n".join(trees)

    def run(self):
        shutil.rmtree(self.out, ignore_errors=True)
        results = sorted(name for name in self.names.values() if name.startswith("results/"))
        for page, name in self.names.items():
            text = self.rewritten(page)
            if name == "index.md":
                text += "\n" + self.navigation()
            elif name == "results.md" and results:
                text += "\n" + toctree(results)
            self.write(name, text)
        for image, name in self.images.items():
            (self.out / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(image, self.out / name)
        if self.problems:
            raise Broken("\n".join(sorted(self.problems)))


def toctree(pages, caption=None):
    """MyST's list of pages; with a caption, only in the navigation."""
    options = [":hidden:", f":caption: {caption}"] if caption else [":titlesonly:"]
    return "\n".join(["```{toctree}", *options, "", *pages, "```", ""])


def python_with_sphinx():
    """This Python or the system's, whichever has the packages; None if neither."""
    for python in (sys.executable, "/usr/bin/python3"):
        if shutil.which(python) and subprocess.run([python, "-c", f"import {MODULES}"], capture_output=True, check=False).returncode == 0:
            return python
    return None


def build(root, work, out):
    """Builds the site of the pages below `root` into `out`; raises Broken."""
    python = python_with_sphinx()
    if python is None:
        raise Broken("Sphinx or MyST is missing; run: scripts/install_packages docs")
    Stage(root, work / "source").run()
    command = [python, "-m", "sphinx", "-b", "html", "-q", "-W", "--keep-going", "-c", str(SITE), "-d", str(work / "doctrees"), str(work / "source"), str(out)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Broken(done.stderr.strip())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    arguments = parser.parse_args()
    try:
        build(ROOT, ROOT / "build/docs", arguments.out.resolve())
    except Broken as problems:
        print(problems, file=sys.stderr)
        return 1
    print(f"{arguments.out}/index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
