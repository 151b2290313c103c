#!/usr/bin/env python3
"""Files: each technique has a test, a benchmark and a page that says when to use it; every test is built; no file is larger
than 1 MiB, and README.md has at most 120 lines; links in the docs have targets, and a page shows each of their images."""

import re

import house

MAX_FILE_BYTES = 1 << 20
MAX_README_LINES = 120
TECHNIQUE_NEEDS = {"README.md": "page", "*_test.cpp": "test", "*_bench.cpp": "benchmark"}
WHEN = "| When to use it |"
TEST_FOLDERS = ("src", "lab", "apps", "tests")
TEST = re.compile(r"[\w./-]+_test\.cpp\b")
IMAGE_SUFFIXES = (".jpg", ".png", ".svg", ".webp")

LINK = re.compile(r"(?<!\\)\[(?:[^\[\]]|\[[^\]]*\])*\]\(<?([^()\s>]+(?:\([^()]*\))?)>?(?:\s+\"[^\"]*\")?\)|(?:src|href)=\"([^\"]+)\"")
CODE = re.compile(r"^```.*?^```[ \t]*$|`[^`\n]*`", re.MULTILINE | re.DOTALL)


def check_techniques(root):
    folders = root / "src" / "techniques"
    problems = []
    for folder in sorted(p for p in folders.glob("*/*") if p.is_dir()):
        for pattern, what in TECHNIQUE_NEEDS.items():
            if not any(folder.glob(pattern)):
                problems.append(f"{folder.relative_to(root)}: has no {what} ({pattern})")
        page = folder / "README.md"
        text = page.read_text(encoding="utf-8") if page.exists() else None
        if text is not None and WHEN not in text:
            problems.append(f"{page.relative_to(root)}: has no row that says when to use it ({WHEN})")
    return problems


def check_tests(root):
    """Tests that no CMakeLists.txt names: they are never built and cannot fail."""
    paths = house.files(root)
    built = set()
    for listing in (p for p in paths if p.name == "CMakeLists.txt"):
        text = re.sub(r"#.*", "", listing.read_text(encoding="utf-8"))
        built.update(listing.parent / name for name in TEST.findall(text))
    tests = [p for p in paths if p.name.endswith("_test.cpp") and p.relative_to(root).parts[0] in TEST_FOLDERS]
    return [f"{path.relative_to(root)}: no CMakeLists.txt names this test" for path in tests if path not in built]


def check_sizes(root):
    sizes = [(path.relative_to(root), path.stat().st_size) for path in house.files(root)]
    return [f"{name}: {size} bytes; at most {MAX_FILE_BYTES}" for name, size in sizes if size > MAX_FILE_BYTES]


def check_readme(root):
    readme = root / "README.md"
    lines = len(readme.read_text(encoding="utf-8").splitlines()) if readme.exists() else 0
    return [f"README.md: {lines} lines; at most {MAX_README_LINES}"] if lines > MAX_README_LINES else []


def anchors(text):
    """Anchors of the headings of a page."""
    names = []
    for heading in re.findall(r"^#+[ \t]+(.*?)[ \t]*$", re.sub(r"^```.*?^```[ \t]*$", "", text, flags=re.MULTILINE | re.DOTALL), re.MULTILINE):
        name = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        names.append(name if name not in names else f"{name}-{names.count(name)}")
    return names


def check_links(root):
    problems = []
    for page in (p for p in house.files(root) if p.suffix == ".md"):
        text = CODE.sub(lambda m: "\n" * m[0].count("\n"), page.read_text(encoding="utf-8"))
        for match in LINK.finditer(text):
            link = match[1] or match[2]
            if re.match(r"[a-z]+:", link):
                continue
            place = f"{page.relative_to(root)}:{text.count(chr(10), 0, match.start()) + 1}"
            target, _, anchor = link.partition("#")
            file = (page.parent / target) if target else page
            if not file.exists():
                problems.append(f"{place}: the link to {link} has no target")
            elif anchor and file.suffix == ".md" and anchor not in anchors(file.read_text(encoding="utf-8")):
                problems.append(f"{place}: {target or page.name} has no heading '{anchor}'")
    return problems


def check_images(root):
    """Images that no page shows: scripts would continue to generate them."""
    shown = set()
    for page in (p for p in house.files(root) if p.suffix == ".md"):
        shown.update((page.parent / (match[1] or match[2]).partition("#")[0]).resolve() for match in LINK.finditer(page.read_text(encoding="utf-8")))
    images = [p for p in house.files(root) if p.is_relative_to(root / "docs/images") and p.suffix in IMAGE_SUFFIXES]
    return [f"{path.relative_to(root)}: no page shows this image" for path in images if path.resolve() not in shown]


def check(root):
    return check_techniques(root) + check_tests(root) + check_sizes(root) + check_readme(root) + check_links(root) + check_images(root)


if __name__ == "__main__":
    house.report(check(house.ROOT))
