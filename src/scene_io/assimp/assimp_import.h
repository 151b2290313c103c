// Runs assimp and takes from its scene what relume uses. Only for a child process: see trial_run.h.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "scene_io/assimp/imported_scene.h"

namespace relume {

struct AssimpSource {
  std::string extension;       ///< lower case, without the dot
  std::string place;           ///< names the file in messages
  std::filesystem::path file;  ///< empty: `bytes` are the file
  std::span<const std::byte> bytes;
};

/// What keeps a file from being read becomes ImportedScene::problem.
ImportedScene import_with_assimp(const AssimpSource& source);

}  // namespace relume
