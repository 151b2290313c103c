// The built-in procedural scenes (docs/scenes.md shows them).
#pragma once

#include <string>
#include <vector>

#include "relume/export.h"
#include "relume/scene.h"

namespace relume {

struct BuiltinSceneInfo {
  std::string name;
  std::string summary;  ///< one line on content and purpose
};

/// All built-in scenes, then those of single experiments.
RELUME_API std::vector<BuiltinSceneInfo> list_builtin_scenes();

/// Builds one of them. Throws Error (not_found) with the nearest name.
RELUME_API Scene builtin_scene(const std::string& name);

}  // namespace relume
