#include "scene_io/gltf/gltf_extras.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "files/json_parse.h"
#include "scene/light_parameters.h"
#include "scene_io/gltf/gltf_value.h"
#include "scene_io/relume_json/overrides.h"

namespace relume::gltf {
namespace {

/// Positive length or angle at `key` of extras.relume; `fallback` if it is absent or not positive.
float positive(const tinygltf::Value& extras, const char* key, float fallback) {
  const tinygltf::Value* relume = object_member(extras, "relume");
  const float value = relume ? to_float(number_member(*relume, key, 0)) : 0.0f;
  return value > 0 ? value : fallback;
}

std::string text(const tinygltf::Value& extras, const char* key) {
  const tinygltf::Value* relume = object_member(extras, "relume");
  return relume ? string_member(*relume, key) : std::string();
}

std::vector<VisibleSet> visible_sets(const JsonObject& root) {
  std::vector<VisibleSet> sets;
  for (const JsonObject& object : root.objects("visible_sets", {"low", "high", "visible"})) {
    for (const char* key : {"low", "high", "visible"}) object.require(key);
    VisibleSet set{object.vec3("low", Vec3(0)), object.vec3("high", Vec3(0)), {}};
    const nlohmann::json& visible = object.at("visible");
    if (!visible.is_array()) object.fail(object.path_of("visible") + " must be a list of indices");
    for (const nlohmann::json& index : visible) {
      const bool is_index = index.is_number_unsigned() && index.get<uint64_t>() <= UINT32_MAX;
      if (!is_index) object.fail(object.path_of("visible") + " must hold indices only, not " + index.dump());
      set.visible.push_back(index.get<uint32_t>());
    }
    sets.push_back(std::move(set));
  }
  return sets;
}

}  // namespace

void apply_scene_extras(const Document& document, Scene& scene) {
  if (document.scene_extras.empty()) return;
  const nlohmann::json json = parse_json(document.scene_extras, document.place);
  const JsonObject root(json, "extras.relume", document.place, {"environment", "settings", "visible_sets"});
  apply_environment(root, document.base_dir, scene);
  if (root.has("settings")) scene.settings_json = root.at("settings").dump();
  scene.visible_sets = visible_sets(root);
}

void apply_camera_extras(const tinygltf::Value& extras, Camera& camera) {
  if (text(extras, "projection") == "panoramic") camera.projection = Projection::panoramic;
  camera.lens_radius = positive(extras, "lens_radius", camera.lens_radius);
  camera.focus_distance = positive(extras, "focus_distance", camera.focus_distance);
}

void apply_light_extras(const tinygltf::Value& extras, PunctualLight& light) {
  for (const LightParameter& p : light_parameters()) {
    if (p.type != light.type || p.gltf_key) continue;
    const float most_deg = glm::degrees(p.most_rad);
    light.*p.member = glm::radians(std::min(positive(extras, p.key, glm::degrees(light.*p.member)), most_deg));
  }
}

void apply_material_extras(const tinygltf::Value& extras, Material& material) {
  if (text(extras, "microfacet_model") == "beckmann") material.microfacet_model = MicrofacetModel::beckmann;
  const tinygltf::Value* relume = object_member(extras, "relume");
  if (relume && relume->Has("cull_back_faces") && relume->Get("cull_back_faces").IsBool())
    material.cull_back_faces = relume->Get("cull_back_faces").Get<bool>();
}

std::string texture_image(const tinygltf::Value& extras) { return text(extras, "image"); }

float texture_glossiness(const tinygltf::Value& extras) {
  const tinygltf::Value* relume = object_member(extras, "relume");
  return relume ? to_float(number_member(*relume, "glossiness", -1)) : -1.0f;
}

}  // namespace relume::gltf
