#include <fmt/format.h>

#include "builtin_scenes/builtin.h"
#include "relume/builtin_scenes.h"
#include "relume/error.h"
#include "scene_io/relume_json/overrides.h"

namespace relume {

Scene build_builtin_scene(const std::string& name, const std::string& place) {
  const BuiltinScene* builtin = find_builtin_scene(name);
  if (builtin) return builtin->build();
  std::string names;
  for (const BuiltinSceneInfo& scene : list_builtin_scenes()) names += (names.empty() ? "" : ", ") + scene.name;
  throw Error(fmt::format("{}: there is no built-in scene '{}'; valid names are {}", place, name, names));
}

}  // namespace relume
