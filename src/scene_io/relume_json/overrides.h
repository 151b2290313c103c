// The parts of a relume JSON file, each applied to the scene that the file refers to. `root` is the whole file. All
// throw Error.
#pragma once

#include <filesystem>

#include "scene/scene.h"
#include "scene_io/relume_json/json_object.h"

namespace relume {

/// "camera" and "camera_keys": one camera that comes before those of the scene, so that it is the default.
void apply_camera(const JsonObject& root, Scene& scene);
/// "lights": added to those of the scene.
void apply_lights(const JsonObject& root, Scene& scene);
/// "environment": replaces that of the scene.
void apply_environment(const JsonObject& root, const std::filesystem::path& base_dir, Scene& scene);
/// "materials": members of the scene's materials, by name.
void apply_materials(const JsonObject& root, Scene& scene);
/// "nodes": transforms and key frames of the scene's nodes, by name.
void apply_nodes(const JsonObject& root, Scene& scene);

/// The scene behind "builtin:NAME". Throws Error with the valid names.
Scene build_builtin_scene(const std::string& name, const std::string& place);

}  // namespace relume
