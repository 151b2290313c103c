#include "scene_io/gltf/gltf_specular_glossiness.h"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace relume::gltf {
namespace {

using nlohmann::json;

constexpr const char* kExtension = "KHR_materials_pbrSpecularGlossiness";

double number(const json& object, const char* key, double fallback) {
  const auto it = object.find(key);
  return it != object.end() && it->is_number() ? it->get<double>() : fallback;
}

/// First `count` numbers at `key`; ones if there is no such list.
json numbers(const json& object, const char* key, size_t count) {
  const auto it = object.find(key);
  const bool usable = it != object.end() && it->is_array() && it->size() >= count &&
                      std::all_of(it->begin(), it->end(), [](const json& x) { return x.is_number(); });
  json result = json::array();
  for (size_t i = 0; i < count; ++i) result.push_back(usable ? (*it)[i].get<double>() : 1.0);
  return result;
}

/// Adds a texture of the same image with texels 1 − glossiness · alpha. Returns its index; −1 if the source texture is
/// missing.
int roughness_texture(json& root, const json& info, double glossiness) {
  const auto textures = root.find("textures");
  const auto index = info.find("index");
  if (textures == root.end() || index == info.end() || !index->is_number_unsigned()) return -1;
  if (index->get<size_t>() >= textures->size()) return -1;
  json copy = (*textures)[index->get<size_t>()];
  copy["extras"] = {{"relume", {{"glossiness", glossiness}}}};
  textures->push_back(std::move(copy));
  return static_cast<int>(textures->size()) - 1;
}

void convert(json& root, json& material, const json& source) {
  json f0 = numbers(source, "specularFactor", 3);
  const double glossiness = std::clamp(number(source, "glossinessFactor", 1), 0.0, 1.0);
  const auto info = source.find("specularGlossinessTexture");
  const bool has_texture = info != source.end() && info->is_object();
  json pbr = {{"metallicFactor", 0}, {"roughnessFactor", 1 - glossiness}};
  json specular = json::object();
  if (has_texture) {
    specular["specularColorTexture"] = *info;
    if (const int texture = roughness_texture(root, *info, glossiness); texture >= 0) {
      pbr["roughnessFactor"] = 1;
      pbr["metallicRoughnessTexture"] = *info;
      pbr["metallicRoughnessTexture"]["index"] = texture;
    }
  }
  for (json& channel : f0) channel = channel.get<double>() / kDefaultF0;
  specular["specularColorFactor"] = std::move(f0);
  // Not scaled by 1 − max F0, which a texture may provide: the interface alone attenuates the diffuse component.
  pbr["baseColorFactor"] = numbers(source, "diffuseFactor", 4);
  if (const auto texture = source.find("diffuseTexture"); texture != source.end()) pbr["baseColorTexture"] = *texture;
  material["pbrMetallicRoughness"] = std::move(pbr);
  material["extensions"]["KHR_materials_specular"] = std::move(specular);
}

}  // namespace

void convert_specular_glossiness(json& root) {
  const auto materials = root.find("materials");
  if (materials == root.end()) return;
  for (json& material : *materials) {
    const json::json_pointer place(std::string("/extensions/") + kExtension);
    if (!material.contains(place) || !material[place].is_object()) continue;
    const json source = material[place];
    convert(root, material, source);
  }
}

}  // namespace relume::gltf
