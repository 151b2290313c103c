#include "viewer/model/save_view.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "builtin_scenes/builtin.h"
#include "files/atomic_file.h"
#include "files/extension.h"
#include "relume/error.h"
#include "scene_io/relume_json/write_view.h"
#include "settings/settings_json.h"

namespace relume::viewer {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// Path of `file` relative to `folder`; absolute if there is none. Throws Error if the working folder is gone.
fs::path from_folder(const fs::path& file, const fs::path& folder) {
  std::error_code failure;
  const fs::path base = fs::absolute(folder, failure);
  const fs::path target = fs::absolute(file, failure);
  if (failure)
    throw Error(fmt::format("{}: the path of the working folder is unknown ({}); start relume in an existing folder",
                            file.string(), failure.message()));
  fs::path relative = fs::relative(target, base, failure);
  return failure || relative.empty() ? target : relative;
}

/// The base of the view: a reference to the scene, or the scene's own relume JSON with paths relative to `folder`.
json base_of(const std::string& scene, const fs::path& folder) {
  if (find_builtin_scene(scene)) return {{"scene", "builtin:" + scene}};
  const fs::path file(scene);
  if (lower_extension(file) != ".json") return {{"scene", from_folder(file, folder).generic_string()}};
  const std::vector<std::byte> bytes = read_file(file);
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  json root = json::parse(text, text + bytes.size(), nullptr, true, true);
  const auto relocate = [&](json& path) {
    path = from_folder(file.parent_path() / path.get<std::string>(), folder).generic_string();
  };
  if (!root.at("scene").get<std::string>().starts_with("builtin:")) relocate(root["scene"]);
  if (root.contains("environment") && root["environment"].contains("map")) relocate(root["environment"]["map"]);
  return root;
}

json path_json(const CameraPath& path) {
  json keys = json::array();
  for (const PathKey& key : path.keys()) keys.push_back(camera_key_to_json(key.time_s, key.eye, key.rotation));
  return keys;
}

/// `file`: the value of the setting `env`, the source of a map; may be empty.
void put_environment(const Environment& e, const fs::path& file, const fs::path& folder, json& root,
                     std::vector<std::string>& omissions) {
  if (e.kind != EnvironmentKind::map) {
    root["environment"] = environment_to_json(e);
  } else if (!file.empty()) {
    root["environment"] = environment_to_json(e);
    root["environment"]["map"] = from_folder(file, folder).generic_string();
  } else if (root.contains("environment") && root["environment"].contains("map")) {
    root["environment"].update(environment_to_json(e));
  } else {
    omissions.emplace_back(
        "the environment map was changed, but its file is unknown; the view keeps the scene's environment");
  }
}

/// Whether relume JSON can address this item by a unique name; otherwise adds an omission.
template <typename Items>
bool can_be_named(const Items& items, Index index, const char* what, std::vector<std::string>& omissions) {
  const std::string& name = items[static_cast<size_t>(index)].name;
  const auto same = std::count_if(items.begin(), items.end(), [&](const auto& item) { return item.name == name; });
  if (name.empty()) omissions.push_back(fmt::format("a {} has no name; its changes are not saved", what));
  if (!name.empty() && same > 1)
    omissions.push_back(fmt::format("a {} shares the name '{}' with another; its changes are not saved", what, name));
  return !name.empty() && same == 1;
}

void put_edits(const Document& document, json& root, std::vector<std::string>& omissions) {
  const Scene& scene = document.outline();
  for (const auto& [index, edit] : document.edits().materials) {
    if (!can_be_named(scene.materials, index, "changed material", omissions)) continue;
    root["materials"][scene.materials[static_cast<size_t>(index)].name].update(material_to_json(edit.value));
  }
  for (const auto& [index, edit] : document.edits().nodes) {
    if (!can_be_named(scene.nodes, index, "moved object", omissions)) continue;
    json& node = root["nodes"][scene.nodes[static_cast<size_t>(index)].name];
    if (node.is_object()) node.erase("keys");  // the move ended its animation
    node.update(transform_to_json(edit.value));
  }
  if (!document.edits().lights.empty()) omissions.emplace_back("changed light intensities are not saved");
}

/// `time_s`: of the animation, or 0 if the view is animated from its start. `base_settings`: those of the base scene,
/// as JSON; may be empty.
void put_settings(const AllSettings& settings, float time_s, const std::string& base_settings, json& root) {
  AllSettings now = settings;
  now.render.time_s = time_s;
  AllSettings defaults;
  AllSettings base;  // also writes defaults that differ from the base's value
  if (!base_settings.empty()) settings_from_json(describe(base), base_settings, "");
  const json all = json::parse(settings_to_json(describe(now)));
  json chosen = json::object();
  const auto add = [&](const SettingList& list) {
    for (const Setting* setting : differing_settings(list, describe(defaults))) {
      // The view stores the camera and the transformed environment separately.
      if (setting->name == "camera" || setting->name.starts_with("env")) continue;
      chosen[setting->name] = all.at(setting->name);
    }
  };
  add(describe(now));
  add(describe(base));
  root.erase("settings");
  if (!chosen.empty()) root["settings"] = chosen;
}

}  // namespace

std::string view_as_json(const SavedView& view, const fs::path& folder, std::vector<std::string>& omissions) {
  json root = base_of(view.document.name(), folder);
  root["camera"] = camera_to_json(view.camera.camera, view.camera.to_world);
  root["camera"]["name"] = "view";
  root.erase("camera_keys");
  const bool moves = view.path && view.path->keys().size() > 1;  // a path needs two keys
  if (moves) root["camera_keys"] = path_json(*view.path);
  put_edits(view.document, root, omissions);
  if (view.document.environment_is_edited())
    put_environment(view.document.outline().environment, view.settings.scene.env, folder, root, omissions);
  if (view.has_ocio_view)
    omissions.emplace_back("the view of --ocio is not saved; give the flag again with the saved view");
  put_settings(view.settings, moves ? 0 : view.document.time_s(), view.document.loaded()->scene.settings_json, root);
  return root.dump(1) + "\n";
}

std::vector<std::string> save_view(const fs::path& file, const SavedView& view) {
  std::vector<std::string> omissions;
  const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  write_file(file, view_as_json(view, folder, omissions));
  return omissions;
}

}  // namespace relume::viewer
