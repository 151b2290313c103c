#!/usr/bin/env python3
"""Places: counts the sources that name a scene format, a material parameter or a light type. docs/extending.md lists them, and one
page beside those of a light type."""

import re

import house

# (kind, pattern of the representative's name, number of places, folder that counts as one place)
REPRESENTATIVES = (
    ("the scene format Mitsuba", re.compile(r"(?<![a-z])mitsuba(?![a-z])", re.IGNORECASE), 2, "src/scene_io/mitsuba/"),
    ("the material parameter iridescence_ior", re.compile(r"\biridescence_ior\b"), 4, None),
    ("the light type spot", re.compile(r"\bPunctualType::spot\b|\bLightKind::spot\b|\bSpotLight\b|\bspot\b(?=[^;]*\bdirectional\b)"), 8, None),
)
FOLDERS = ("include", "src", "apps")

# Formats with their own materials, lights and meshes, which they convert in their own code.
OWN_MODELS = ("src/scene_io/pbrt/",)


def sources(root):
    """Sources that a program is built from, without tests, benchmarks and what they share."""
    for path in house.code_files(root):
        parts = path.relative_to(root).parts
        name = path.relative_to(root).as_posix()
        if parts[0] in FOLDERS and "testing" not in parts and not house.is_test_or_benchmark(path) and not name.startswith(OWN_MODELS):
            yield name, house.without_comments(path.read_text(encoding="utf-8"), keep_strings=True)


def places(texts, names, folder):
    """Files whose text names the representative; those in `folder` are one place."""
    found = {folder if folder and name.startswith(folder) else name for name, text in texts if names.search(text)}
    return sorted(found)


def check(root, representatives=REPRESENTATIVES):
    texts = list(sources(root))
    problems = []
    for what, names, count, folder in representatives:
        found = places(texts, names, folder)
        if not found:
            problems.append(f"tests/house/check_places.py: nothing names {what}; choose another representative")
        elif len(found) != count:
            problems.append(f"{what} is named in {len(found)} places, not in the {count} of docs/extending.md: {', '.join(found)}")
    return problems


if __name__ == "__main__":
    house.report(check(house.ROOT))
