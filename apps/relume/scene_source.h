// Scenes by the name that the user gives.
#pragma once

#include <string>

#include "scene/scene.h"

namespace relume::cli {

/// A built-in scene if there is one of that name, or else a file. Throws Error.
Scene open_scene(const std::string& name);

}  // namespace relume::cli
