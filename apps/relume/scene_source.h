// Scenes by the name that the user gives.
#pragma once

#include <string>

#include "render/settings.h"
#include "scene/scene.h"

namespace relume::cli {

/// A built-in scene if there is one of that name, or else a file. Throws Error. `shows_progress`: as
/// PreparationProgress does.
Scene open_scene(const std::string& name, bool shows_progress = false);

/// apply(), which may load an environment map; `shows_progress` as above.
void override_scene(const SceneOverrides& overrides, Scene& scene, bool shows_progress);

}  // namespace relume::cli
