#include "scene_io/gltf/gltf_materials.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "relume/error.h"
#include "scene_io/gltf/gltf_extras.h"
#include "scene_io/gltf/gltf_value.h"

namespace relume::gltf {
namespace {

constexpr float kLargest = 1e30f;
/// KHR_materials_ior: 0 requests a Fresnel reflectance of 1 at every angle, which a large index approximates.
constexpr float kIorOfZero = 1000;

const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto it = extensions.find(name);
  return it == extensions.end() ? nullptr : &it->second;
}

AlphaMode alpha_mode(const std::string& name) {
  if (name == "MASK") return AlphaMode::mask;
  if (name == "BLEND") return AlphaMode::blend;
  return AlphaMode::opaque;
}

}  // namespace

Index MaterialImporter::import(int material) {
  if (material < 0) return kNone;
  const auto& materials = document_.model.materials;
  if (static_cast<size_t>(material) >= materials.size()) {
    document_.warnings.add(
        fmt::format("a mesh refers to material {}, which does not exist; it gets the default material", material));
    return kNone;
  }
  const auto [entry, is_new] = known_.try_emplace(material, static_cast<Index>(scene_.materials.size()));
  const Index index = entry->second;
  if (!is_new) return index;
  scene_.materials.emplace_back();  // the parts of a mixture follow
  Material converted = convert(materials[static_cast<size_t>(material)]);
  scene_.materials[static_cast<size_t>(index)] = std::move(converted);
  return index;
}

Index MaterialImporter::find(int material) const {
  const auto entry = known_.find(material);
  return entry == known_.end() ? kNone : entry->second;
}

Material MaterialImporter::convert(const tinygltf::Material& source) {
  Material material;
  material.name = source.name;
  convert_core(source, material);
  convert_extensions(source, material);
  return material;
}

void MaterialImporter::convert_core(const tinygltf::Material& source, Material& m) {
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  m.base_color = limited(to_vec3(pbr.baseColorFactor, Vec3(1)), 1, "base colour", m.name);
  m.alpha = pbr.baseColorFactor.size() > 3 ? limited(pbr.baseColorFactor[3], 0, 1, "alpha", m.name) : 1.0f;
  m.base_color_texture = reference(pbr.baseColorTexture, TextureUse::color);
  m.metallic = limited(pbr.metallicFactor, 0, 1, "metallic", m.name);
  m.roughness = limited(pbr.roughnessFactor, 0, 1, "roughness", m.name);
  m.metallic_roughness_texture = reference(pbr.metallicRoughnessTexture, TextureUse::data);
  m.normal_texture = reference(source.normalTexture, TextureUse::normal);
  m.normal_scale = limited(source.normalTexture.scale, -kLargest, kLargest, "normal scale", m.name);
  m.emission = limited(to_vec3(source.emissiveFactor, Vec3(0)), kMaxRadiance, "emission", m.name);
  m.emission_texture = reference(source.emissiveTexture, TextureUse::color);
  m.alpha_mode = alpha_mode(source.alphaMode);
  m.alpha_cutoff = limited(source.alphaCutoff, 0, kLargest, "alpha cutoff", m.name);
  m.double_sided = source.doubleSided;
  m.cull_back_faces = !source.doubleSided;  // glTF 2.0, §3.9.5
  if (source.occlusionTexture.index >= 0)
    document_.warnings.note("occlusion textures are ignored; occlusion is computed");
}

void MaterialImporter::convert_emission_strength(const tinygltf::Material& source, Material& m) {
  const auto* e = find_extension(source.extensions, "KHR_materials_emissive_strength");
  if (!e) return;
  m.emission *= limited(number_member(*e, "emissiveStrength", 1), 0, kLargest, "emissive strength", m.name);
  m.emission = limited(m.emission, kMaxRadiance, "emission", m.name);
}

void MaterialImporter::read(const tinygltf::Value& extension, const MaterialParameter& p, const Material& m,
                            float& value) {
  const double number = number_member(extension, p.gltf.key, value);
  const auto is = [&](float Material::*member) { return p.member == MaterialParameter::Member(member); };
  if (is(&Material::ior) && number == 0) {
    value = kIorOfZero;
    return;
  }
  if (is(&Material::attenuation_distance) && (number <= 0 || std::isinf(number))) return;  // no absorption
  value = limited(number, p.range.low, std::min(p.range.high, kLargest), p.name, m.name);
}

void MaterialImporter::read(const tinygltf::Value& extension, const MaterialParameter& p, const Material& m,
                            Rgb& value) {
  value = limited(vec3_member(extension, p.gltf.key, value), p.range.high, p.name, m.name);
}

void MaterialImporter::read(const tinygltf::Value& extension, const MaterialParameter& p, const Material&,
                            TextureRef& value) {
  const TextureUse data = p.texture_scale ? TextureUse::normal : TextureUse::data;
  value = reference(extension, p.gltf.key, p.color_texture ? TextureUse::color : data);
}

/// Reads "scale" of the extensions' normal textures.
void MaterialImporter::read_texture_scales(const tinygltf::Material& source, Material& m) {
  for (const MaterialParameter& p : material_parameters()) {
    if (!p.texture_scale || !p.gltf.extension) continue;
    const auto* extension = find_extension(source.extensions, p.gltf.extension);
    const tinygltf::Value* info = extension ? object_member(*extension, p.gltf.key) : nullptr;
    if (info) m.*p.texture_scale = limited(number_member(*info, "scale", 1), -kLargest, kLargest, p.name, m.name);
  }
}

void MaterialImporter::convert_extensions(const tinygltf::Material& source, Material& m) {
  convert_emission_strength(source, m);
  for_each_parameter(m, [&](const MaterialParameter& p, auto& value) {
    const auto* extension = p.gltf.extension ? find_extension(source.extensions, p.gltf.extension) : nullptr;
    if constexpr (requires { read(*extension, p, m, value); }) {
      if (extension) read(*extension, p, m, value);
    }
  });
  read_texture_scales(source, m);
  apply_material_extras(source.extras, m);
  read_mixture(source.extras, m);
  m.unlit = find_extension(source.extensions, "KHR_materials_unlit") != nullptr;
  const auto* volume = find_extension(source.extensions, "KHR_materials_volume");
  if (volume && object_member(*volume, "thicknessTexture"))
    document_.warnings.add("thickness textures are ignored; rays measure the thickness");
}

/// Reads the mixture that MaterialWriter wrote. Throws Error if too many are nested.
void MaterialImporter::read_mixture(const tinygltf::Value& extras, Material& m) {
  const tinygltf::Value* relume = object_member(extras, "relume");
  const tinygltf::Value* mix = relume ? object_member(*relume, "mix") : nullptr;
  if (!mix) return;
  const int first = integer_member(*mix, "first", -1);
  const int second = integer_member(*mix, "second", -1);
  const auto exists = [&](int i) { return i >= 0 && static_cast<size_t>(i) < document_.model.materials.size(); };
  if (!exists(first) || !exists(second)) {
    document_.warnings.add(fmt::format(
        "material '{}': a part of its mixture does not exist; its own parameters replace the mixture", m.name));
    return;
  }
  if (mix_depth_ == kMaxMixDepth)
    throw Error(
        fmt::format("{}: material '{}' is part of itself, or more than {} mixtures are nested; change its parts",
                    document_.place, m.name, kMaxMixDepth));
  m.mix_share = limited(number_member(*mix, "share", 0.5), 0, 1, "share", m.name);
  m.mix_texture = reference(*mix, "texture", TextureUse::data);
  ++mix_depth_;
  m.mix_first = import(first);
  m.mix_second = import(second);
  --mix_depth_;
}

TextureRef MaterialImporter::reference(int texture, int uv_set, const tinygltf::Value* transform, TextureUse use) {
  TextureRef ref;
  ref.texture = textures_.request(texture, use);
  ref.uv_set = uv_set;
  if (transform) {
    ref.offset = vec2_member(*transform, "offset", Vec2(0));
    ref.scale = vec2_member(*transform, "scale", Vec2(1));
    ref.rotation_rad = to_float(number_member(*transform, "rotation", 0));
    ref.uv_set = integer_member(*transform, "texCoord", uv_set);
  }
  if (ref.uv_set < 0 || ref.uv_set > 1) {
    document_.warnings.add(fmt::format("texture coordinate set {} is not supported; set 0 is used", ref.uv_set));
    ref.uv_set = 0;
  }
  return ref;
}

/// Reference of tinygltf's TextureInfo or NormalTextureInfo.
template <typename Info>
TextureRef MaterialImporter::reference(const Info& info, TextureUse use) {
  if (info.index < 0) return {};
  return reference(info.index, info.texCoord, find_extension(info.extensions, "KHR_texture_transform"), use);
}

/// Reference of the texture info at `key` of a material extension.
TextureRef MaterialImporter::reference(const tinygltf::Value& extension, const char* key, TextureUse use) {
  const tinygltf::Value* info = object_member(extension, key);
  if (!info) return {};
  const tinygltf::Value* extensions = object_member(*info, "extensions");
  const tinygltf::Value* transform = extensions ? object_member(*extensions, "KHR_texture_transform") : nullptr;
  return reference(integer_member(*info, "index", -1), integer_member(*info, "texCoord", 0), transform, use);
}

float MaterialImporter::limited(double value, double low, double high, const char* what, const std::string& material) {
  if (value >= low && value <= high) return static_cast<float>(value);
  const auto nearest = static_cast<float>(std::clamp(value, low, high));
  document_.warnings.add(
      fmt::format("material '{}': {} {} is out of range; {} is used", material, what, value, nearest));
  return nearest;
}

Vec3 MaterialImporter::limited(const Vec3& value, float high, const char* what, const std::string& material) {
  return {limited(value.x, 0, high, what, material), limited(value.y, 0, high, what, material),
          limited(value.z, 0, high, what, material)};
}

}  // namespace relume::gltf
