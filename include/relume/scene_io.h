// Scene files in: the formats of docs/scene-formats.md. Scene files out: glTF.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "relume/export.h"
#include "relume/scene.h"

namespace relume {

/// Loads a scene file; its first bytes or its extension select the format. Scene::warnings lists ignored and repaired
/// parts. A file without an environment gets EnvironmentKind::automatic. Throws Error; never crashes or hangs on
/// malformed files.
RELUME_API Scene load_scene(const std::filesystem::path& file);

/// Writes .gltf (with .bin and .png beside it) or .glb, each file under a temporary name first. Reading it back gives
/// the same image; docs/scenes.md says where things go that glTF has no form for. Returns what could not be said
/// exactly, one sentence each. Throws Error for other extensions, when a file cannot be written
/// and where one would replace a file of Scene::source_files.
RELUME_API std::vector<std::string> write_gltf(const std::filesystem::path& file, const Scene& scene);

/// Replaces the environment by an equirectangular EXR or HDR file. Throws Error.
RELUME_API void load_environment_map(const std::filesystem::path& file, Environment& environment);

}  // namespace relume
