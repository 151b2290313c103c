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

/// Scenes of single experiments: variants of the scenes above, and series that differ in a seed. They are found by name
/// as the others. Tests and experiments over all built-in scenes leave them out.
const std::vector<BuiltinScene>& experiment_scenes();

/// Finds a built-in scene or a scene of an experiment. Returns nullptr if no scene has that name.
const BuiltinScene* find_builtin_scene(std::string_view name);

}  // namespace relume
