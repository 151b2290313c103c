// The built-in procedural scenes (docs/scenes.md shows them).
#pragma once

#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace relume {

struct BuiltinScene {
  std::string_view name;
  std::string_view summary;  ///< one line: what is in it and what it is for; says in brackets if something moves
  Scene (*build)();
};

/// All of them, in the order in which `relume scenes` lists them.
const std::vector<BuiltinScene>& builtin_scenes();

/// nullptr if there is none of that name.
const BuiltinScene* find_builtin_scene(std::string_view name);

}  // namespace relume
