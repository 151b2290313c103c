#include "scene_io/assimp/assimp_materials.h"

#include <algorithm>

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <fmt/format.h>

namespace relume {
namespace {

struct TextureSlot {
  std::string path;
  int uv_set = 0;
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
};

WrapMode wrap_mode(aiTextureMapMode mode) {
  switch (mode) {
    case aiTextureMapMode_Clamp:
    case aiTextureMapMode_Decal: return WrapMode::clamp;
    case aiTextureMapMode_Mirror: return WrapMode::mirror;
    default: return WrapMode::repeat;
  }
}

/// Texture of the first of these kinds in the material.
TextureSlot find_texture(const aiMaterial& material, std::initializer_list<aiTextureType> kinds) {
  for (const aiTextureType kind : kinds) {
    aiString path;
    unsigned uv_set = 0;
    aiTextureMapMode modes[2] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    if (material.GetTexture(kind, 0, &path, nullptr, &uv_set, nullptr, nullptr, modes) != aiReturn_SUCCESS ||
        path.length == 0)
      continue;
    return {path.C_Str(), uv_set == 1 ? 1 : 0, wrap_mode(modes[0]), wrap_mode(modes[1])};
  }
  return {};
}

float number(const aiMaterial& material, const char* key, unsigned type, unsigned index, float fallback, float low,
             float high) {
  ai_real value = 0;
  if (material.Get(key, type, index, value) != aiReturn_SUCCESS || !is_finite(value)) return fallback;
  return std::clamp(value, low, high);
}

/// Reads a colour clamped to [0, high]. Returns false if the material has no such colour.
bool color(const aiMaterial& material, const char* key, unsigned type, unsigned index, float high, Rgb& result) {
  aiColor3D value;
  if (material.Get(key, type, index, value) != aiReturn_SUCCESS) return false;
  const Rgb rgb(value.r, value.g, value.b);
  if (!is_finite(rgb)) return false;
  result = glm::clamp(rgb, Rgb(0), Rgb(high));
  return true;
}

/// Index of the texture request with these images; appends it if new.
Index request_texture(std::vector<TextureRequest>& textures, const TextureRequest& wanted) {
  for (size_t i = 0; i < textures.size(); ++i) {
    const TextureRequest& t = textures[i];
    if (t.recipe == wanted.recipe && t.first == wanted.first && t.second == wanted.second &&
        t.wrap_u == wanted.wrap_u && t.wrap_v == wanted.wrap_v)
      return static_cast<Index>(i);
  }
  textures.push_back(wanted);
  return static_cast<Index>(textures.size()) - 1;
}

TextureRef make_ref(std::vector<TextureRequest>& textures, TextureRecipe recipe, const TextureSlot& first,
                    const TextureSlot& second = {}) {
  if (first.path.empty() && second.path.empty()) return {};
  const TextureSlot& lead = first.path.empty() ? second : first;
  TextureRef ref;
  ref.texture = request_texture(textures, {recipe, lead.wrap_u, lead.wrap_v, first.path, second.path});
  ref.uv_set = lead.uv_set;
  return ref;
}

void convert_metallic_roughness(const aiMaterial& source, Material& m) {
  color(source, AI_MATKEY_BASE_COLOR, 1, m.base_color);
  m.metallic = number(source, AI_MATKEY_METALLIC_FACTOR, 0, 0, 1);
  m.roughness = number(source, AI_MATKEY_ROUGHNESS_FACTOR, 1, 0, 1);
}

void convert_diffuse_specular(const aiMaterial& source, Material& m) {
  constexpr float kDark = 0.04f;
  constexpr float kBright = 0.25f;
  constexpr float kMaxExponent = 1e6f;
  Rgb specular(0);
  color(source, AI_MATKEY_COLOR_SPECULAR, 1, specular);
  const float exponent = number(source, AI_MATKEY_SHININESS, 0, 0, kMaxExponent);
  const bool is_matt = exponent == 0 || is_black(specular);
  m.roughness = is_matt ? 1.0f : std::sqrt(std::sqrt(2.0f / (exponent + 2.0f)));
  m.metallic = 0;
  m.specular = is_matt ? 0.0f : std::min(1.0f, max_component(specular) / kDark);
  const bool has_color_texture = source.GetTextureCount(aiTextureType_DIFFUSE) > 0;
  if (!is_matt && !has_color_texture && max_component(m.base_color) < kDark && max_component(specular) > kBright) {
    m.base_color = specular;
    m.metallic = 1;
    m.specular = 1;
  }
}

void convert_emission(const aiMaterial& source, std::vector<TextureRequest>& textures, Material& m,
                      Warnings& warnings) {
  constexpr float kLargest = 1e30f;
  color(source, AI_MATKEY_COLOR_EMISSIVE, kLargest, m.emission);
  m.emission_texture = make_ref(textures, TextureRecipe::color,
                                find_texture(source, {aiTextureType_EMISSION_COLOR, aiTextureType_EMISSIVE}));
  if (m.emission_texture.used() && is_black(m.emission)) m.emission = Rgb(1);
  m.emission *= number(source, AI_MATKEY_EMISSIVE_INTENSITY, 1, 0, kLargest);
  if (!(max_component(m.emission) <= kMaxRadiance))
    warnings.add(
        fmt::format("material '{}': its emission is above {:g} and is reduced to this limit", m.name, kMaxRadiance));
  m.emission = glm::min(m.emission, Rgb(kMaxRadiance));
}

void convert_colors(const aiMaterial& source, std::vector<TextureRequest>& textures, Material& m) {
  const TextureSlot base = find_texture(source, {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE});
  const TextureSlot opacity = find_texture(source, {aiTextureType_OPACITY});
  const TextureRecipe recipe = opacity.path.empty() ? TextureRecipe::color : TextureRecipe::color_and_alpha;
  // Exporters write a black or dark Kd beside a texture; these formats do not multiply the two consistently.
  m.base_color = Rgb(0.8f);
  const bool has_diffuse = color(source, AI_MATKEY_COLOR_DIFFUSE, 1, m.base_color);
  m.base_color_texture = make_ref(textures, recipe, base, opacity);
  if (!base.path.empty() && (!has_diffuse || is_black(m.base_color))) m.base_color = Rgb(1);
  m.alpha = number(source, AI_MATKEY_OPACITY, 1, 0, 1);
  if (m.alpha < 1) m.alpha_mode = AlphaMode::blend;
  if (!opacity.path.empty()) m.alpha_mode = AlphaMode::mask;
}

void convert_textures(const aiMaterial& source, std::vector<TextureRequest>& textures, Material& m,
                      Warnings& warnings) {
  const TextureSlot roughness = find_texture(source, {aiTextureType_DIFFUSE_ROUGHNESS});
  const TextureSlot metalness = find_texture(source, {aiTextureType_METALNESS});
  // A single image for both already has glTF's layout.
  const bool is_packed = !roughness.path.empty() && roughness.path == metalness.path;
  m.metallic_roughness_texture = is_packed ? make_ref(textures, TextureRecipe::data, roughness)
                                           : make_ref(textures, TextureRecipe::roughness_metal, roughness, metalness);
  m.normal_texture =
      make_ref(textures, TextureRecipe::normal,
               find_texture(source, {aiTextureType_NORMAL_CAMERA, aiTextureType_NORMALS, aiTextureType_HEIGHT}));
  if (source.GetTextureCount(aiTextureType_SPECULAR) + source.GetTextureCount(aiTextureType_SHININESS) > 0)
    warnings.add("specular and shininess textures are ignored; their factors are used");
  if (source.GetTextureCount(aiTextureType_DISPLACEMENT) > 0) warnings.add("displacement textures are ignored");
}

Material convert(const aiMaterial& source, std::vector<TextureRequest>& textures, Warnings& warnings) {
  Material m;
  m.name = source.GetName().C_Str();
  convert_colors(source, textures, m);
  ai_real factor = 0;
  const bool is_pbr = source.Get(AI_MATKEY_METALLIC_FACTOR, factor) == aiReturn_SUCCESS ||
                      source.Get(AI_MATKEY_ROUGHNESS_FACTOR, factor) == aiReturn_SUCCESS;
  if (is_pbr) {
    convert_metallic_roughness(source, m);
  } else {
    convert_diffuse_specular(source, m);
  }
  convert_emission(source, textures, m, warnings);
  convert_textures(source, textures, m, warnings);
  m.ior = number(source, AI_MATKEY_REFRACTI, 1.5f, 0, 1000);
  if (m.ior < 1.01f) m.ior = 1.5f;  // OBJ files write 1 for "none"
  m.transmission = number(source, AI_MATKEY_TRANSMISSION_FACTOR, 0, 0, 1);
  m.clearcoat = number(source, AI_MATKEY_CLEARCOAT_FACTOR, 0, 0, 1);
  m.clearcoat_roughness = number(source, AI_MATKEY_CLEARCOAT_ROUGHNESS_FACTOR, 0, 0, 1);
  // These formats have no sidedness, and many of their models rely on two-sided faces.
  m.double_sided = true;
  return m;
}

/// Whether the material has an emissive colour without its texture.
bool emits_evenly(const aiMaterial& source) {
  Rgb own(0);
  color(source, AI_MATKEY_COLOR_EMISSIVE, kMaxRadiance, own);
  return !is_black(own);
}

}  // namespace

void import_assimp_materials(const aiScene& source, ImportedScene& imported, Warnings& warnings) {
  for (unsigned i = 0; i < source.mNumMaterials; ++i) {
    const Material& material =
        imported.scene.materials.emplace_back(convert(*source.mMaterials[i], imported.textures, warnings));
    if (material.emission_texture.used() && !emits_evenly(*source.mMaterials[i]))
      imported.texture_lamps.push_back(static_cast<Index>(i));
  }
}

}  // namespace relume
