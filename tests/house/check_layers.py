#!/usr/bin/env python3
"""Layers: which folder of src/ and lab/, and tools/, may include which, and which folders may use which library (docs/architecture.md).

Tests and benchmarks beside the code, and everything outside these folders, may include anything; only libraries that belong to one
folder are kept from apps/, too. The check reports permissions that no code uses, as these would let the next violation through.
"""

import re

import house

# The roots of includes. Those of lab/ build on those of src/, never the reverse.
ROOTS = ("src", "lab")

# Programs that make the figures and tables, compiled without the library. They have a row of the table, too.
TOOLS = "tools"

# The public interfaces, include/relume and lab/include/relume, which everything may include and which include nothing else of
# the project.
INTERFACE = "relume"

# Folder -> the folders it may include, besides itself. No cycles.
MAY_INCLUDE = {
    "core": "",
    "testing": "core",  # used by tests only
    "settings": "core",
    "sampling": "core",
    "materials": "core sampling",
    "lights": "core sampling materials",
    "scene": "core sampling materials lights accel",
    "accel": "core",
    "builtin_scenes": "core settings scene",
    "files": "core",
    "image": "core files",
    "scene_io": "core scene builtin_scenes files image",
    "framebuffer": "core",
    "metrics": "core",
    "report": "core framebuffer",
    "frame": "core sampling scene framebuffer",
    "techniques": "core settings sampling lights scene framebuffer frame",
    "render": "core settings sampling materials accel scene files framebuffer frame techniques",
    "parts": "core settings files image framebuffer render",
    "compare": "core settings scene files metrics report render",
    "interface": "core compare experiments",  # of relume_lab, implemented
    "experiments": "core settings scene builtin_scenes files metrics report techniques render compare",
    TOOLS: "core materials",
}

# A technique that builds on another names it here: "technique": "the ones whose headers it includes".
TECHNIQUE_MAY_INCLUDE = {
    "path": "markov_chain markov_chain_lights octree primary_hits",
    "bdpt": "markov_chain markov_chain_lights octree path",
    "vcm": "bdpt path",
    "directional_quadtree": "octree",
    "markov_grid": "hash_grid",
    "markov_chain": "markov_grid",
    "markov_chain_lights": "light_tree markov_grid",
    "direction_view": "directional_quadtree octree path",
    "visibility_light_cache": "octree",
    "adaptive_tiles": "octree",
    "features": "path primary_hits reprojection",
    "shared": "features path primary_hits reprojection",  # by denoisers
    "bmfr": "features shared",
    "svgf": "shared",
    "asvgf": "path reprojection shared svgf",
    "caustic_layer": "features shared svgf",
    "reprojection": "path reservoir",
    "path_space_filter": "hash_grid path primary_hits",
    "adaptive_psf": "bdpt path path_space_filter vcm",
    "path_graphs": "adaptive_psf path path_space_filter",
    "sharc": "octree path path_space_filter",
    "reservoir": "markov_chain_lights octree path reprojection",
    "restir_di": "path reservoir",
    "restir_gi": "path reservoir",
    "restir_pt": "path path_graphs path_space_filter reservoir sharc",
}

# The parts of the viewer -> the parts that each may include, besides itself.
VIEWER = "apps/relume/viewer"
VIEWER_MAY_INCLUDE = {
    "render": "",
    "model": "render",
    "panels": "model render",
}

# The closed lists of a slot's strategies, with what these share: strategies include them, and they include strategies.
SLOTS = ("direction_sampling", "light_selection")

# Start of an include -> the folders that may use that library.
LIBRARY_USERS = {
    "embree": "accel",
    "tiny_gltf": "scene_io",
    "assimp/": "scene_io",
    "draco/": "scene_io",
    "meshoptimizer": "scene_io",
    "pugixml": "scene_io",
    "stb_": "image scene_io",
    "OpenEXR/": "image",
    "Imf": "image",
    "zstd": "frame image",
    "zlib": "scene_io",
    "webp/": "image",
    "OpenColorIO/": "framebuffer",
    "CLI/": "apps",
    "boost/": "apps",
    "turbojpeg": "apps",
}

# The Python bindings, which include their own files and public headers only.
BINDINGS = "python/bindings"

# Slow to compile: kept out of the headers that other folders include, those directly in src/FOLDER/.
HEAVY = ("nlohmann/json.hpp", "CLI/", "assimp/", "tiny_gltf", "OpenEXR/", "Imf", "draco/", "pugixml", "fmt/ranges", "embree")

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">]+)[">]', re.MULTILINE)


def check_table(table):
    """The table itself: known names, no cycles."""
    problems = [f"the table lets {a} include {b}, but has no row for {b}" for a in table for b in table[a].split() if b not in table]
    if problems:
        return problems
    layered = set()
    while len(layered) < len(table):
        ready = [a for a in table if a not in layered and set(table[a].split()) <= layered]
        if not ready:
            return [f"the table has a cycle among {', '.join(sorted(set(table) - layered))}"]
        layered.update(ready)
    return []


def check_include(folder, technique, target):
    """Problem of an include of `target`, a path below src/, or None."""
    parts = target.split("/")
    if parts[0] == INTERFACE:
        return None
    if len(parts) < 2 or parts[0] not in MAY_INCLUDE:
        return "is not a path from src/ or lab/"
    if parts[0] != folder and parts[0] not in MAY_INCLUDE[folder].split():
        return f"breaks the layers: {folder} may include {MAY_INCLUDE[folder] or 'nothing'}"
    other = parts[2] if parts[0] == "techniques" and len(parts) > 3 else None  # techniques/GROUP/TECHNIQUE/file
    if technique and other and other != technique and not {technique, other} & set(SLOTS):
        if other not in TECHNIQUE_MAY_INCLUDE.get(technique, "").split():
            return f"makes {technique} include another technique"
    return None


def is_test(path):
    return house.is_test_or_benchmark(path) or "testing" in path.parts


def check_viewer(name, target):
    """Problem of an include of `target`, a path below apps/relume, in the file `name`, or None."""
    part = name.removeprefix(f"{VIEWER}/").split("/")[0]
    if not name.startswith(f"{VIEWER}/") or part not in VIEWER_MAY_INCLUDE or not target.startswith("viewer/"):
        return None
    allowed = VIEWER_MAY_INCLUDE[part]
    if target.split("/")[1] in (part, *allowed.split()):
        return None
    return f"breaks the layers of the viewer: {part} may include {allowed or 'nothing'}"


def row_of(parts):
    """Row of the table for a path below the root."""
    return parts[1] if parts[0] in ROOTS and len(parts) > 2 else parts[0]


def includes(path):
    """Matches of INCLUDE in a file, with their lines."""
    text = house.without_comments(path.read_text(encoding="utf-8"), keep_strings=True)
    return [(match, text.count(chr(10), 0, match.start()) + 1) for match in INCLUDE.finditer(text)]


def check_file(root, path):
    parts = path.relative_to(root).parts
    if "include" in parts[:2]:
        return [
            f"{path}:{line}: #include of {match[2]}: the public interface includes only itself, the standard library and glm"
            for match, line in includes(path)
            if (match[1] == '"' and not match[2].startswith(f"{INTERFACE}/")) or (match[1] == "<" and "/" in match[2] and not match[2].startswith("glm/"))
        ]
    if path.relative_to(root).as_posix().startswith(f"{BINDINGS}/"):
        return [
            f"{path}:{line}: #include of {match[2]}: the bindings include only public headers and their own"
            for match, line in includes(path)
            if match[1] == '"' and "/" in match[2] and not match[2].startswith(f"{INTERFACE}/")
        ]
    in_src = parts[0] in ROOTS and len(parts) > 2
    if in_src and parts[1] not in MAY_INCLUDE:
        return [f"{path}:1: {parts[0]}/{parts[1]} is not in the table of layers"]
    folder = row_of(parts)
    layered = in_src or folder == TOOLS
    technique = parts[3] if folder == "techniques" and len(parts) > 4 else None
    problems = []
    for match, line in includes(path):
        place = f"{path}:{line}: #include of {match[2]}"
        if path.suffix == ".h" and in_src and len(parts) == 3 and match[2].startswith(HEAVY):
            problems.append(f"{place}: slow to compile; only .cpp files and headers of subfolders include it")
        if (not layered and folder != "apps") or is_test(path):
            continue
        problem = check_include(folder, technique, match[2]) if layered and match[1] == '"' else check_viewer(path.relative_to(root).as_posix(), match[2])
        if problem:
            problems.append(f"{place}: {problem}")
        for library, users in LIBRARY_USERS.items():
            if match[1] == "<" and match[2].startswith(library) and folder not in users.split():
                problems.append(f"{place}: only {users} may use this library")
    return problems


def unused_permissions(root, folders=MAY_INCLUDE, techniques=TECHNIQUE_MAY_INCLUDE):
    """Includes that the tables of layers allow, but no code has."""
    used = set()
    for path in house.code_files(root):
        parts = path.relative_to(root).parts
        if parts[0] not in (*ROOTS, TOOLS) or "include" in parts[:2] or is_test(path):
            continue
        for match, _ in includes(path):
            target = match[2].split("/")
            used.add((row_of(parts), target[0]))
            if row_of(parts) == target[0] == "techniques":
                used.add((parts[3], target[2]))
    return [
        f"the table lets {a} include {b}, which it does not"
        for table in (folders, techniques)
        for a in table
        for b in table[a].split()
        if b != "core" and (a, b) not in used  # all folders may include core
    ]


def check(root):
    problems = check_table(MAY_INCLUDE)
    for path in house.code_files(root):
        problems += check_file(root, path)
    return problems


if __name__ == "__main__":
    house.report(check(house.ROOT) + unused_permissions(house.ROOT))
