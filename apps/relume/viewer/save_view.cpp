#include "viewer/save_view.h"

#include <nlohmann/json.hpp>

#include "io/atomic_file.h"
#include "io/relume_json/write_view.h"
#include "scene/builtin.h"
#include "settings/settings_json.h"

namespace relume::viewer {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

fs::path from_folder(const fs::path& file, const fs::path& folder) {
  const fs::path relative = fs::relative(fs::absolute(file), fs::absolute(folder));
  return relative.empty() ? fs::absolute(file) : relative;
}

/// The file that the view builds on: a reference to the scene, or the relume JSON it came from with its paths made
/// right.
json base_of(const std::string& scene, const fs::path& folder) {
  if (find_builtin_scene(scene)) return {{"scene", "builtin:" + scene}};
  const fs::path file(scene);
  if (file.extension() != ".json") return {{"scene", from_folder(file, folder).generic_string()}};
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

void put_environment(const Environment& e, json& root, std::vector<std::string>& omissions) {
  if (e.kind != EnvironmentKind::map) {
    root["environment"] = environment_to_json(e);
  } else if (root.contains("environment") && root["environment"].contains("map")) {
    root["environment"].update(environment_to_json(e));
  } else {
    omissions.emplace_back("the environment map was changed, but its file is not known; it stays that of the scene");
  }
}

void put_edits(const Document& document, json& root, std::vector<std::string>& omissions) {
  const Scene& scene = document.outline();
  for (const auto& [index, edit] : document.edits().materials) {
    const std::string& name = scene.materials[static_cast<size_t>(index)].name;
    if (name.empty()) {
      omissions.emplace_back("a changed material has no name and stays as it was");
    } else {
      root["materials"][name].update(material_to_json(edit.value));
    }
  }
  for (const auto& [index, edit] : document.edits().nodes) {
    const std::string& name = scene.nodes[static_cast<size_t>(index)].name;
    if (name.empty()) {
      omissions.emplace_back("a moved object has no name and stays where it was");
      continue;
    }
    root["nodes"][name].update(transform_to_json(edit.value));
  }
  if (!document.edits().lights.empty())
    omissions.emplace_back("changed lights keep the intensity that their file gives them");
  if (document.edits().environment.version > 0) put_environment(scene.environment, root, omissions);
}

void put_settings(const Settings& settings, json& root) {
  Settings now = settings;
  Settings defaults;
  const json all = json::parse(settings_to_json(describe(now)));
  json chosen = json::object();
  const SettingList list = describe(now);  // the result points into it
  for (const Setting* setting : differing_settings(list, describe(defaults))) {
    // The view says these itself.
    if (setting->name == "camera" || setting->name == "env" || setting->name == "scene-time") continue;
    chosen[setting->name] = all.at(setting->name);
  }
  root.erase("settings");
  if (!chosen.empty()) root["settings"] = chosen;
}

}  // namespace

std::string view_as_json(const SavedView& view, const fs::path& folder, std::vector<std::string>& omissions) {
  json root = base_of(view.document.name(), folder);
  root["camera"] = camera_to_json(view.camera.camera, view.camera.to_world);
  root["camera"]["name"] = "view";
  root.erase("camera_keys");
  if (view.path && !view.path->keys().empty()) root["camera_keys"] = path_json(*view.path);
  put_edits(view.document, root, omissions);
  put_settings(view.settings, root);
  return root.dump(1) + "\n";
}

std::vector<std::string> save_view(const fs::path& file, const SavedView& view) {
  std::vector<std::string> omissions;
  const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  write_file(file, view_as_json(view, folder, omissions));
  return omissions;
}

}  // namespace relume::viewer
