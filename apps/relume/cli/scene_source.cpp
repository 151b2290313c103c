#include "cli/scene_source.h"

#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "builtin_scenes/builtin.h"
#include "cli/preparation_progress.h"
#include "relume/builtin_scenes.h"
#include "relume/error.h"
#include "relume/scene_io.h"
#include "settings/nearest_name.h"

namespace relume::cli {

Scene open_scene(const std::string& name, bool shows_progress) {
  const PreparationProgress progress(shows_progress);
  if (const BuiltinScene* builtin = find_builtin_scene(name)) return builtin->build();
  std::error_code failure;
  if (std::filesystem::exists(name, failure)) return load_scene(name);
  std::vector<std::string> names;
  for (const BuiltinSceneInfo& builtin : list_builtin_scenes()) names.push_back(builtin.name);
  const std::string nearest = nearest_name(name, names);
  throw Error(
      fmt::format("{}: there is no such file and no built-in scene of that name{}", name,
                  nearest.empty() ? "; `relume scenes` lists them" : fmt::format("; did you mean '{}'?", nearest)));
}

void override_scene(const SceneOverrides& overrides, Scene& scene, bool shows_progress) {
  const PreparationProgress progress(shows_progress);
  apply(overrides, scene);
}

}  // namespace relume::cli
