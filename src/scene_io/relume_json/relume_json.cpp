#include "scene_io/relume_json/relume_json.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "files/bytes.h"
#include "files/extension.h"
#include "files/json_parse.h"
#include "relume/error.h"
#include "relume/scene_io.h"
#include "scene_io/relume_json/overrides.h"

namespace relume {
namespace {

constexpr std::string_view kBuiltinPrefix = "builtin:";

Scene load_base_scene(const JsonObject& root, const std::filesystem::path& base_dir, const std::string& place) {
  root.require("scene");
  const std::string reference = root.string("scene", "");
  if (reference.starts_with(kBuiltinPrefix)) return build_builtin_scene(reference.substr(kBuiltinPrefix.size()), place);
  const std::filesystem::path file = resolve_uri(base_dir, reference, place);
  if (lower_extension(file) == ".json")
    root.fail("scene must not be another JSON file; name a model or a built-in scene");
  if (const std::string reason = missing_reason(file); !reason.empty())
    root.fail(fmt::format("scene is {}, but this file {}; check its path", file.string(), reason));
  return load_scene(file);
}

}  // namespace

Scene load_relume_json_from_memory(std::span<const std::byte> file, const std::filesystem::path& base_dir,
                                   const std::string& place) {
  const nlohmann::json document = parse_json({reinterpret_cast<const char*>(file.data()), file.size()}, place);
  const JsonObject root(document, "", place,
                        {"scene", "camera", "camera_keys", "lights", "environment", "materials", "nodes", "settings"});
  Scene scene = load_base_scene(root, base_dir, place);
  apply_materials(root, scene);
  apply_lights(root, scene);
  apply_nodes(root, scene);
  apply_environment(root, base_dir, scene);
  apply_camera(root, scene);
  if (root.has("settings")) {
    const JsonObject settings = root.object("settings", {});
    nlohmann::json merged = nlohmann::json::parse(scene.settings_json.empty() ? "{}" : scene.settings_json);
    merged.update(root.at("settings"));
    scene.settings_json = merged.dump();
  }
  scene.name = std::filesystem::path(place).stem().string();
  validate(scene, place);
  return scene;
}

Scene load_relume_json(const std::filesystem::path& file) {
  return load_relume_json_from_memory(read_file_bytes(file), file.parent_path(), file.string());
}

}  // namespace relume
