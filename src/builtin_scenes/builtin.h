// The built-in procedural scenes (docs/scenes.md shows them).
#pragma once

#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace relume {

struct BuiltinScene {
  std::string_view name;
  std::string_view summary;  ///< one line on content and purpose; motion in brackets
  Scene (*build)();
};

/// All built-in scenes, in the order of `relume scenes`.
const std::vector<BuiltinScene>& builtin_scenes();

/// Returns nullptr if no scene has that name.
const BuiltinScene* find_builtin_scene(std::string_view name);

}  // namespace relume
