// Applies the parts of a relume JSON file to its base scene. `root` is the whole file. All throw Error.
#pragma once

#include <filesystem>

#include "scene/scene.h"
#include "scene_io/relume_json/json_object.h"

namespace relume {

/// "camera" and "camera_keys": inserts a camera before those of the scene, which makes it the default.
void apply_camera(const JsonObject& root, Scene& scene);
/// "lights": adds lights.
void apply_lights(const JsonObject& root, Scene& scene);
/// "environment": replaces the scene's environment.
void apply_environment(const JsonObject& root, const std::filesystem::path& base_dir, Scene& scene);
/// "materials": changes members of materials, selected by name.
void apply_materials(const JsonObject& root, Scene& scene);
/// "nodes": changes transforms and key frames of nodes, selected by name.
void apply_nodes(const JsonObject& root, Scene& scene);

/// Scene of "builtin:NAME". Throws Error with the valid names.
Scene build_builtin_scene(const std::string& name, const std::string& place);

}  // namespace relume
