// Scenes by the name that the user gives.
#pragma once

#include <string>

#include "scene/scene.h"

namespace relume::cli {

/// A built-in scene if there is one of that name, or else a file. Throws Error. `shows_progress`: as
/// PreparationProgress does.
Scene open_scene(const std::string& name, bool shows_progress = false);

}  // namespace relume::cli
