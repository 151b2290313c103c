// Scenes by the user's name for them.
#pragma once

#include <string>

#include "render/settings.h"
#include "scene/scene.h"

namespace relume::cli {

/// The built-in scene of that name, else a file. Throws Error. `shows_progress`: see PreparationProgress.
Scene open_scene(const std::string& name, bool shows_progress = false);

/// apply(), which may load an environment map; `shows_progress` as above.
void override_scene(const SceneOverrides& overrides, Scene& scene, bool shows_progress);

}  // namespace relume::cli
