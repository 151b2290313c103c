// Material extensions whose images have a closed form: what a smooth surface in uniform light of radiance 1 shows is
// how much of it returns.
#include <gtest/gtest.h>

#include <cmath>

#include "gltf_features/stage.h"

namespace relume::support {
namespace {

/// Black and smooth: shows reflections at its interface alone.
json polished(const json& extensions) {
  return {{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0}}},
          {"extensions", extensions}};
}

/// Mean of an image of the square with `material`, its normal turned away from the viewer by `angle` radians, in
/// uniform light of radiance 1.
Rgb furnace(const json& material, float angle = 0, int spp = 4) {
  Stage stage;
  stage.show(stage.square(), material, {{"rotation", rotation_json({0, 1, 0}, angle)}, {"scale", {9, 9, 1}}});
  return estimate_of(image(stage.load(1), 16, spp)).mean;
}

void expect_rgb(const Rgb& value, const Rgb& expected, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], tolerance) << "channel " << c;
}

/// [Schlick94].
Rgb schlick(const Rgb& f0, const Rgb& f90, float angle) {
  return f0 + (f90 - f0) * static_cast<float>(std::pow(1 - std::cos(static_cast<double>(angle)), 5));
}

constexpr float kAngles[] = {0, 1.1f};

TEST(GltfMaterial, EmissiveStrengthMultiplies) {
  json material = matte_json(0);
  material["emissiveFactor"] = {0.25, 0.5, 1};
  material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 12;
  expect_rgb(furnace(material), {3, 6, 12}, 1e-5f);
}

TEST(GltfMaterial, IorSetsReflectance) {
  for (const float ior : {1.0f, 1.33f, 1.5f, 2.4f}) {
    const float f0 = ((ior - 1) / (ior + 1)) * ((ior - 1) / (ior + 1));
    for (const float angle : kAngles)
      expect_rgb(furnace(polished({{"KHR_materials_ior", {{"ior", ior}}}}), angle), schlick(Rgb(f0), Rgb(1), angle),
                 1e-4f);
  }
  // 0 asks for total reflection, which a large index comes close to.
  expect_rgb(furnace(polished({{"KHR_materials_ior", {{"ior", 0}}}})), Rgb(1), 0.005f);
}

TEST(GltfMaterial, SpecularScalesBothEndsAndItsColorTheNear) {
  const json extension = {{"specularFactor", 0.6}, {"specularColorFactor", {1, 0.5, 4}}};
  for (const float angle : kAngles)
    expect_rgb(furnace(polished({{"KHR_materials_specular", extension}}), angle),
               schlick(0.6f * 0.04f * Rgb(1, 0.5f, 4), Rgb(0.6f), angle), 1e-4f);
}

TEST(GltfMaterial, SpecularColorIsLimitedToTotalReflection) {  // min(0.04 · colour, 1) · factor
  const json extension = {{"specularFactor", 0.5}, {"specularColorFactor", {100, 1, 1}}};
  expect_rgb(furnace(polished({{"KHR_materials_specular", extension}})), {0.5f, 0.02f, 0.02f}, 1e-4f);
}

TEST(GltfMaterial, ClearcoatReflects) {
  const json extensions = {{"KHR_materials_specular", {{"specularFactor", 0}}},
                           {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.7}, {"clearcoatRoughnessFactor", 0}}}};
  for (const float angle : kAngles)
    expect_rgb(furnace(polished(extensions), angle), 0.7f * schlick(Rgb(0.04f), Rgb(1), angle), 1e-4f);
}

TEST(GltfMaterial, TransmissionTints) {
  json material = polished({{"KHR_materials_transmission", {{"transmissionFactor", 1}}}});
  material["pbrMetallicRoughness"]["baseColorFactor"] = {0.9, 0.5, 0.2, 1};
  // What is not reflected passes; which of the two a sample follows is random.
  expect_rgb(furnace(material, 0, 256), Rgb(0.04f) + 0.96f * Rgb(0.9f, 0.5f, 0.2f), 0.005f);
  material["extensions"]["KHR_materials_specular"]["specularFactor"] = 0;
  expect_rgb(furnace(material), {0.9f, 0.5f, 0.2f}, 1e-5f);
}

TEST(GltfMaterial, TransmissionSharesWithTheDiffuseBase) {
  json material = matte_json(1);
  material["pbrMetallicRoughness"]["roughnessFactor"] = 0;
  material["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 0.3;
  Stage stage;
  stage.show(stage.square(), material, {{"translation", {0, 0, 1}}});
  stage.show(stage.square(), glowing_json({0.5, 0.25, 1}));
  // Nothing but the card behind shines: the diffuse base sees the dark.
  expect_rgb(estimate_of(image(stage.load(), 16, 256)).mean, 0.3f * Rgb(0.5f, 0.25f, 1), 0.005f);
}

/// A wedge: no thickness at the left edge of the image, 2 m at the right.
int add_wedge(Stage& stage, const json& material) {
  const int positions = stage.file.floats({-1, 2, 0, -1, -2, 0, 1, 2, 0, 1, -2, 0, 1, 2, -2, 1, -2, -2}, 3);
  const std::vector<uint16_t> triangles = {0, 1, 2, 2, 1, 3, 0, 4, 1, 1, 4, 5, 2, 3, 4, 4, 3, 5, 0, 2, 4, 1, 5, 3};
  const json primitive = {{"attributes", {{"POSITION", positions}}},
                          {"indices", stage.file.accessor(triangles, 1, 5123)},
                          {"material", stage.file.add("materials", material)}};
  const int mesh = stage.file.add("meshes", {{"primitives", json::array({primitive})}});
  return stage.file.add_root({{"mesh", mesh}});
}

json transmissive(double ior) {
  json material =
      polished({{"KHR_materials_transmission", {{"transmissionFactor", 1}}}, {"KHR_materials_ior", {{"ior", ior}}}});
  material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 1};
  return material;
}

TEST(GltfMaterial, VolumeAbsorbsByThickness) {  // attenuation colour ^ (way / attenuation distance)
  json material = transmissive(1);
  material["extensions"]["KHR_materials_volume"] = {
      {"thicknessFactor", 1}, {"attenuationColor", {0.9, 0.5, 0.2}}, {"attenuationDistance", 0.8}};
  Stage stage;
  add_wedge(stage, material);
  expect_pixels(image(stage.load(1), 16, 64), 0.01, [](double x, double) {  // jitter within a pixel
    const double way = (x + 1) / 0.8;
    return Rgb(std::pow(0.9, way), std::pow(0.5, way), std::pow(0.2, way));
  });
}

/// A card whose right part from `edge` on is bright, below a slab 1 m thick that is turned by 0.8 radians.
Scene edge_below_slab(json glass, float edge) {
  glass["extensions"]["KHR_materials_volume"]["thicknessFactor"] = 1;
  Stage stage;
  const std::vector<float> box = {-4, 4, 0, 4, 4, 0, -4, -4, 0, 4, -4, 0, -4, 4, -1, 4, 4, -1, -4, -4, -1, 4, -4, -1};
  const std::vector<uint16_t> triangles = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6};  // front and back suffice
  const json primitive = {{"attributes", {{"POSITION", stage.file.floats(box, 3)}}},
                          {"indices", stage.file.accessor(triangles, 1, 5123)},
                          {"material", stage.file.add("materials", glass)}};
  stage.file.add_root({{"mesh", stage.file.add("meshes", {{"primitives", json::array({primitive})}})},
                       {"rotation", rotation_json({0, 1, 0}, 0.8f)}});
  stage.show(stage.square(), glowing_json({1, 1, 1}), {{"translation", {edge + 9, 0, -20}}, {"scale", {9, 9, 1}}});
  return stage.load();
}

TEST(GltfMaterial, VolumeRefractsByItsIor) {  // a slab shifts what lies behind by t sin(θ − θ') / cos θ'
  const double refracted = std::asin(std::sin(0.8) / 1.5);
  const float shift = static_cast<float>(std::sin(0.8 - refracted) / std::cos(refracted));
  // The slab's normal leans to the right, so rays leave it further to the left of where they would have gone.
  const Image straight = image(edge_below_slab(transmissive(1), shift), 16, 16);
  const Image bent = image(edge_below_slab(transmissive(1.5), 0), 16, 256);
  const auto column = [](const Image& image, int x) {
    double sum = 0;
    for (int y = 0; y < image.height; ++y) sum += static_cast<double>(image.at(x, y).r) / image.height;
    return sum;
  };
  const double cos_i = std::cos(0.8);
  const double cos_t = std::cos(refracted);
  const double parallel = (1.5 * cos_i - cos_t) / (1.5 * cos_i + cos_t);
  const double perpendicular = (cos_i - 1.5 * cos_t) / (cos_i + 1.5 * cos_t);
  const double reflectance = 0.5 * (parallel * parallel + perpendicular * perpendicular);
  // Both interfaces reflect; light that goes to and fro between them comes out elsewhere, mostly on the bright part.
  const double passed = (1 - reflectance) * (1 - reflectance);
  for (int x = 0; x < 16; ++x) EXPECT_NEAR(column(bent, x), passed * column(straight, x), 0.02) << "column " << x;
  EXPECT_GT(column(straight, 15), 0.9);
  EXPECT_LT(column(straight, 0), 0.1);
}

TEST(GltfMaterial, DispersionShiftsEachChannelByItsIndex) {
  json glass = transmissive(1.5);
  glass["extensions"]["KHR_materials_specular"]["specularFactor"] = 0;
  glass["extensions"]["KHR_materials_dispersion"]["dispersion"] = 2;  // an Abbe number of 10
  const Rgb mean = estimate_of(image(edge_below_slab(glass, 0), 16, 1024)).mean;
  constexpr double kMeanWavelengths[] = {611.4, 549.1, 465.1};  // of the channels' responses, nanometres
  for (int c = 0; c < 3; ++c) {
    const double index = 1.5 + 0.05 * (523655 / (kMeanWavelengths[c] * kMeanWavelengths[c]) - 1.5168);
    const double refracted = std::asin(std::sin(0.8) / index);
    const double shift = std::sin(0.8 - refracted) / std::cos(refracted);
    EXPECT_NEAR(mean[c], 0.5 * (1 - shift), 1.5e-3) << "channel " << c;
  }
  EXPECT_GT(mean.r - mean.b, 0.005f);
}

TEST(GltfMaterial, UnlitIgnoresLighting) {  // factor · texture · vertex colour
  Stage stage;
  json attributes = stage.square();
  attributes["COLOR_0"] = stage.file.floats({1, 0.5, 0.25, 1, 0.5, 0.25, 1, 0.5, 0.25, 1, 0.5, 0.25}, 3);
  stage.sun();
  stage.show(attributes, unlit_json(stage.texture(1, 1, {188, 255, 255, 255}), {0.5, 0.5, 0.5, 1}));
  const float texel = static_cast<float>(linear_of(188));
  expect_pixels(image(stage.load(2)), 1e-5, [&](double, double) { return 0.5f * Rgb(texel, 0.5f, 0.25f); });
}

}  // namespace
}  // namespace relume::support
