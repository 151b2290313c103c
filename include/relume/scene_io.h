// Reads the scene formats of docs/scene-formats.md, and writes glTF and pbrt-v4.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "relume/export.h"
#include "relume/scene.h"

namespace relume {

/// Loads a scene file; its first bytes or its extension select the format. Scene::warnings lists ignored and repaired
/// parts. A file without an environment gets EnvironmentKind::automatic; with lights of pbrt, none. Throws Error for
/// malformed files; never crashes or hangs on them.
RELUME_API Scene load_scene(const std::filesystem::path& file);

/// Writes .gltf (with .bin and .png beside it) or .glb, each file under a temporary name first. Reading the result
/// gives the same image. docs/scenes.md describes how parts without a glTF form are stored. Returns the inexact parts,
/// one sentence each. Throws Error for other extensions, for failed writes, and instead of replacing a file of
/// Scene::source_files.
RELUME_API std::vector<std::string> write_gltf(const std::filesystem::path& file, const Scene& scene);

/// Writes .pbrt, with meshes and images in the folder "STEM.pbrt-data" beside it, each file under a temporary name
/// first. docs/formats.md describes what becomes of materials and lights. Returns the inexact parts, one sentence each.
/// Throws Error for other extensions, for failed writes, and instead of replacing a file of Scene::source_files.
RELUME_API std::vector<std::string> write_pbrt(const std::filesystem::path& file, const Scene& scene);

/// Writes the format of the extension, in upper or lower case: write_gltf() or write_pbrt(). Throws Error for others.
RELUME_API std::vector<std::string> write_scene(const std::filesystem::path& file, const Scene& scene);

/// Replaces the environment with an equirectangular EXR or HDR file. Throws Error.
RELUME_API void load_environment_map(const std::filesystem::path& file, Environment& environment);

}  // namespace relume
