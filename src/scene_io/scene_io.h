// Scene files in: glTF, what assimp reads, relume JSON. Scene files out: glTF.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace relume {

/// Loads by extension and content: .gltf and .glb; .json (relume's own, which refers to another scene file or to a
/// built-in scene by name and overrides parts of it); PLY by our own reader; everything else through assimp. What is
/// ignored or repaired becomes one of Scene::warnings. Throws Error; never crashes or hangs on malformed files.
Scene load_scene(const std::filesystem::path& file);

Scene load_gltf(const std::filesystem::path& file);
Scene load_assimp(const std::filesystem::path& file);
Scene load_relume_json(const std::filesystem::path& file);

/// Writes .gltf (with .bin and .png beside it) or .glb, each file under a temporary name first. Reading it back gives
/// the same picture; docs/scenes.md says where things go that glTF has no form for. Returns what could not be said
/// exactly, one sentence each. Throws Error for other extensions, when a file cannot be written
/// and where one would replace a file of Scene::source_files.
std::vector<std::string> write_gltf(const std::filesystem::path& file, const Scene& scene);

/// Replaces the environment by an equirectangular EXR or HDR file. Throws Error.
void load_environment_map(const std::filesystem::path& file, Environment& environment);

}  // namespace relume
