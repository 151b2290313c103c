// Runs assimp and converts its scene. Only for a child process: see trial_run.h.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "scene_io/assimp/imported_scene.h"

namespace relume {

struct AssimpSource {
  std::string extension;       ///< lower case, without the dot
  std::string place;           ///< name of the file in messages
  std::filesystem::path file;  ///< empty if `bytes` holds the file
  std::span<const std::byte> bytes;
};

/// Imports one file. Failures to read it are returned in ImportedScene::problem.
ImportedScene import_with_assimp(const AssimpSource& source);

}  // namespace relume
