// The loaders behind load_scene().
#pragma once

#include <filesystem>

#include "relume/scene_io.h"
#include "scene/scene.h"

namespace relume {

Scene load_gltf(const std::filesystem::path& file);
Scene load_assimp(const std::filesystem::path& file);
Scene load_relume_json(const std::filesystem::path& file);

}  // namespace relume
