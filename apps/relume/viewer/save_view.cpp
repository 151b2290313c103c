#include "viewer/save_view.h"

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "io/atomic_file.h"
#include "scene/builtin.h"
#include "settings/settings_json.h"

namespace relume::viewer {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

json to_json(const Vec3& v) { return {v.x, v.y, v.z}; }

/// As "nodes" of relume JSON wants it: about X, then Y, then Z.
Vec3 euler_deg(const glm::quat& q) { return glm::degrees(glm::eulerAngles(q)); }

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

json camera_json(const PlacedCamera& placed) {
  constexpr const char* kProjections[] = {"perspective", "orthographic", "panoramic"};
  const Camera& c = placed.camera;
  const Vec3 eye(placed.to_world[3]);
  return {{"name", "view"},
          {"projection", kProjections[static_cast<int>(c.projection)]},
          {"eye", to_json(eye)},
          {"target", to_json(eye - glm::normalize(Vec3(placed.to_world[2])))},
          {"up", to_json(glm::normalize(Vec3(placed.to_world[1])))},
          {"fov_y_deg", glm::degrees(c.fov_y_rad)},
          {"half_height", c.half_height},
          {"lens_radius", c.lens_radius},
          {"focus_distance", c.focus_distance}};
}

json path_json(const CameraPath& path) {
  json keys = json::array();
  for (const PathKey& key : path.keys()) {
    const Vec3 target = key.eye + key.rotation * Vec3(0, 0, -1);
    keys.push_back({{"time", key.time_s}, {"eye", to_json(key.eye)}, {"target", to_json(target)}});
  }
  return keys;
}

json material_json(const Material& m) {
  json object = {{"base_color", to_json(m.base_color)},
                 {"metallic", m.metallic},
                 {"roughness", m.roughness},
                 {"emission", to_json(m.emission)},
                 {"transmission", m.transmission},
                 {"ior", m.ior},
                 {"specular", m.specular},
                 {"clearcoat", m.clearcoat},
                 {"clearcoat_roughness", m.clearcoat_roughness}};
  return object;
}

json sun_sky_json(const SunSky& s) {
  return {{"elevation_deg", glm::degrees(s.sun_elevation_rad)},
          {"azimuth_deg", glm::degrees(s.sun_azimuth_rad)},
          {"turbidity", s.turbidity},
          {"sky_scale", s.sky_scale},
          {"sun_scale", s.sun_scale},
          {"sun_angular_diameter_deg", glm::degrees(s.sun_angular_diameter_rad)},
          {"ground_albedo", to_json(s.ground_albedo)}};
}

void put_environment(const Environment& e, json& root, std::vector<std::string>& omissions) {
  const float rotation_deg = glm::degrees(e.rotation_rad);
  switch (e.kind) {
    case EnvironmentKind::none: root["environment"] = {{"constant", 0}}; break;
    case EnvironmentKind::constant: root["environment"] = {{"constant", to_json(e.color)}}; break;
    case EnvironmentKind::sun_sky:
      root["environment"] = {
          {"sun_sky", sun_sky_json(e.sun_sky)}, {"rotation_deg", rotation_deg}, {"scale", to_json(e.color)}};
      break;
    case EnvironmentKind::map:
      if (root.contains("environment") && root["environment"].contains("map")) {
        root["environment"]["rotation_deg"] = rotation_deg;
        root["environment"]["scale"] = to_json(e.color);
      } else {
        omissions.emplace_back(
            "the environment map was changed, but its file is not known; it stays that of the scene");
      }
  }
}

void put_edits(const Document& document, json& root, std::vector<std::string>& omissions) {
  const Scene& scene = document.outline();
  for (const auto& [index, edit] : document.edits().materials) {
    const std::string& name = scene.materials[static_cast<size_t>(index)].name;
    if (name.empty()) {
      omissions.emplace_back("a changed material has no name and stays as it was");
    } else {
      root["materials"][name].update(material_json(edit.value));
    }
  }
  for (const auto& [index, edit] : document.edits().nodes) {
    const std::string& name = scene.nodes[static_cast<size_t>(index)].name;
    if (name.empty()) {
      omissions.emplace_back("a moved object has no name and stays where it was");
      continue;
    }
    root["nodes"][name].update({{"translation", to_json(edit.value.translation)},
                                {"rotation_deg", to_json(euler_deg(edit.value.rotation))},
                                {"scale", to_json(edit.value.scale)}});
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
  root["camera"] = camera_json(view.camera);
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
