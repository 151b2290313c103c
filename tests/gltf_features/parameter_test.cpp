// Tests textures of material parameters: each multiplies its factor by exactly the channel that glTF names. Compares a
// texture of 2 × 2 texels on the square with four quarters that have the products as factors.
#include <gtest/gtest.h>

#include <array>

#include "gltf_features/stage.h"

namespace relume::support {
namespace {

constexpr std::array<std::array<int, 4>, 4> kTexels = {
    {{64, 160, 32, 255}, {200, 90, 250, 128}, {120, 230, 100, 64}, {30, 60, 180, 200}}};
constexpr std::array<int, 4> kWhite = {255, 255, 255, 255};

double data(int code) { return code / 255.0; }

/// Material with a parameter of `texel`, times 0.8 if the factor supports it. If `texture` is not null, it provides the
/// value, and `texel` is white.
using MakeMaterial = json (*)(const std::array<int, 4>& texel, const json& texture);

void set(json& object, const char* key, const json& texture) {
  if (!texture.is_null()) object[key] = texture;
}

json with_extension(json material, const char* name, const json& extension) {
  material["extensions"][name] = extension;
  return material;
}

/// Dark plastic with the default gloss.
json dark() { return {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {0.05, 0.05, 0.05, 1}}}}}; }

json base_color(const std::array<int, 4>& t, const json& texture) {
  json material = matte_json(1);
  json& pbr = material["pbrMetallicRoughness"];
  pbr["baseColorFactor"] = {0.8 * linear_of(t[0]), 0.8 * linear_of(t[1]), 0.8 * linear_of(t[2]), 1};
  set(pbr, "baseColorTexture", texture);
  return material;
}

json metallic_roughness(const std::array<int, 4>& t, const json& texture) {
  json pbr = {{"baseColorFactor", {0.9, 0.6, 0.3, 1}},
              {"roughnessFactor", 0.8 * data(t[1])},
              {"metallicFactor", 0.8 * data(t[2])}};
  set(pbr, "metallicRoughnessTexture", texture);
  return {{"pbrMetallicRoughness", pbr}};
}

json emissive(const std::array<int, 4>& t, const json& texture) {
  json material = matte_json(0);
  material["emissiveFactor"] = {0.8 * linear_of(t[0]), 0.8 * linear_of(t[1]), 0.8 * linear_of(t[2])};
  set(material, "emissiveTexture", texture);
  return with_extension(material, "KHR_materials_emissive_strength", {{"emissiveStrength", 3}});
}

json specular(const std::array<int, 4>& t, const json& texture) {
  json material = dark();
  material["pbrMetallicRoughness"]["roughnessFactor"] = 0.4;
  json extension = {{"specularFactor", 0.8 * data(t[3])}};
  set(extension, "specularTexture", texture);
  return with_extension(material, "KHR_materials_specular", extension);
}

json specular_color(const std::array<int, 4>& t, const json& texture) {
  json material = dark();
  material["pbrMetallicRoughness"]["roughnessFactor"] = 0.4;
  json extension = {{"specularColorFactor", {0.8 * linear_of(t[0]), 0.8 * linear_of(t[1]), 0.8 * linear_of(t[2])}}};
  set(extension, "specularColorTexture", texture);
  return with_extension(material, "KHR_materials_specular", extension);
}

json clearcoat(const std::array<int, 4>& t, const json& texture) {
  json extension = {{"clearcoatFactor", 0.8 * data(t[0])}, {"clearcoatRoughnessFactor", 0.4}};
  set(extension, "clearcoatTexture", texture);
  return with_extension(dark(), "KHR_materials_clearcoat", extension);
}

json clearcoat_roughness(const std::array<int, 4>& t, const json& texture) {
  json extension = {{"clearcoatFactor", 1}, {"clearcoatRoughnessFactor", 0.8 * data(t[1])}};
  set(extension, "clearcoatRoughnessTexture", texture);
  return with_extension(dark(), "KHR_materials_clearcoat", extension);
}

json transmission(const std::array<int, 4>& t, const json& texture) {
  json material = {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.5}}}};
  json extension = {{"transmissionFactor", 0.8 * data(t[0])}};
  set(extension, "transmissionTexture", texture);
  return with_extension(material, "KHR_materials_transmission", extension);
}

json sheen(const json& color, double roughness) {
  return {{"sheenColorFactor", color}, {"sheenRoughnessFactor", roughness}};
}

json sheen_color(const std::array<int, 4>& t, const json& texture) {
  json extension = sheen({0.8 * linear_of(t[0]), 0.8 * linear_of(t[1]), 0.8 * linear_of(t[2])}, 0.7);
  set(extension, "sheenColorTexture", texture);
  return with_extension(dark(), "KHR_materials_sheen", extension);
}

json sheen_roughness(const std::array<int, 4>& t, const json& texture) {
  json extension = sheen({1, 1, 1}, 0.8 * data(t[3]));
  set(extension, "sheenRoughnessTexture", texture);
  return with_extension(dark(), "KHR_materials_sheen", extension);
}

json film(double share, double thickness_nm) {
  return {{"iridescenceFactor", share},
          {"iridescenceThicknessMinimum", 200},
          {"iridescenceThicknessMaximum", thickness_nm}};
}

json iridescence(const std::array<int, 4>& t, const json& texture) {
  json extension = film(0.8 * data(t[0]), 400);
  set(extension, "iridescenceTexture", texture);
  return with_extension(dark(), "KHR_materials_iridescence", extension);
}

json iridescence_thickness(const std::array<int, 4>& t, const json& texture) {
  json extension = film(1, 200 + 500 * data(t[1]));
  set(extension, "iridescenceThicknessTexture", texture);
  return with_extension(dark(), "KHR_materials_iridescence", extension);
}

json diffuse_transmission(const std::array<int, 4>& t, const json& texture) {
  json extension = {{"diffuseTransmissionFactor", 0.8 * data(t[3])}};
  set(extension, "diffuseTransmissionTexture", texture);
  return with_extension(matte_json(0.8), "KHR_materials_diffuse_transmission", extension);
}

/// No reflection: the light comes from behind.
json diffuse_transmission_color(const std::array<int, 4>& t, const json& texture) {
  json extension = {
      {"diffuseTransmissionFactor", 1},
      {"diffuseTransmissionColorFactor", {0.8 * linear_of(t[0]), 0.8 * linear_of(t[1]), 0.8 * linear_of(t[2])}}};
  set(extension, "diffuseTransmissionColorTexture", texture);
  return with_extension(matte_json(0.8), "KHR_materials_diffuse_transmission", extension);
}

/// The square's quarter for texel `i`.
json quarter(Stage& stage, size_t i) {
  const float x = static_cast<float>(i % 2);
  const float y = static_cast<float>(i / 2);
  return {{"POSITION", stage.file.floats({x - 1, 1 - y, 0, x, 1 - y, 0, x - 1, -y, 0, x, -y, 0}, 3)}};
}

Scene parameter(Way way, MakeMaterial material) {
  Stage stage;
  stage.sun();
  if (way == Way::plain) {
    for (size_t i = 0; i < kTexels.size(); ++i) stage.show(quarter(stage, i), material(kTexels[i], {}));
  } else {
    std::vector<uint8_t> texels;
    for (const auto& texel : kTexels) {
      for (const int channel : texel) texels.push_back(static_cast<uint8_t>(channel));
    }
    const json texture = way == Way::feature ? stage.texture(2, 2, texels) : json();
    stage.show(stage.square(), material(kWhite, texture));
  }
  return stage.load(0.3f);
}

const FeatureCase kCases[] = {
    {"BaseColor", [](Way way) { return parameter(way, base_color); }},
    {"MetallicRoughness", [](Way way) { return parameter(way, metallic_roughness); }},
    {"Emissive", [](Way way) { return parameter(way, emissive); }},
    {"Specular", [](Way way) { return parameter(way, specular); }},
    {"SpecularColor", [](Way way) { return parameter(way, specular_color); }},
    {"Clearcoat", [](Way way) { return parameter(way, clearcoat); }},
    {"ClearcoatRoughness", [](Way way) { return parameter(way, clearcoat_roughness); }},
    {"Transmission", [](Way way) { return parameter(way, transmission); }},
    {"SheenColor", [](Way way) { return parameter(way, sheen_color); }},
    {"SheenRoughness", [](Way way) { return parameter(way, sheen_roughness); }},
    {"Iridescence", [](Way way) { return parameter(way, iridescence); }},
    {"IridescenceThickness", [](Way way) { return parameter(way, iridescence_thickness); }},
    {"DiffuseTransmission", [](Way way) { return parameter(way, diffuse_transmission); }},
    {"DiffuseTransmissionColor", [](Way way) { return parameter(way, diffuse_transmission_color); }},
};

class ParameterTexture : public FeatureTest {};
TEST_P(ParameterTexture, MultipliesItsFactor) { check(); }
INSTANTIATE_TEST_SUITE_P(Gltf, ParameterTexture, ::testing::ValuesIn(kCases), feature_name);

}  // namespace
}  // namespace relume::support
