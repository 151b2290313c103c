// Tests normal maps. A matte square under a directional light shows albedo / π · E · cos of the angle between light and
// mapped normal. This reveals every component of the normal.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "gltf_features/stage.h"

namespace relume::support {
namespace {

constexpr double kAlbedo = 0.8;
constexpr double kIlluminance = 10;

/// Four normals of different inclination, as channel codes.
constexpr std::array<std::array<int, 3>, 4> kCodes = {
    {{200, 128, 220}, {128, 70, 220}, {90, 160, 230}, {128, 128, 255}}};

std::vector<uint8_t> normal_texels() {
  std::vector<uint8_t> texels;
  for (const auto& [r, g, b] : kCodes)
    texels.insert(texels.end(),
                  {static_cast<uint8_t>(r), static_cast<uint8_t>(g), static_cast<uint8_t>(b), uint8_t{255}});
  return texels;
}

/// Tangent-space normal of a code, with x and y scaled.
glm::dvec3 decoded(const std::array<int, 3>& code, double scale = 1) {
  const auto unpack = [](int c) { return 2 * c / 255.0 - 1; };
  return glm::normalize(glm::dvec3(scale * unpack(code[0]), scale * unpack(code[1]), unpack(code[2])));
}

/// Light from the right and slightly above.
constexpr float kTilt = 0.5f;
const Vec3 kTurnsTheLight = {-0.6f, 0.8f, 0};
const glm::dvec3 kToLight = {0.8 * std::sin(0.5), 0.6 * std::sin(0.5), std::cos(0.5)};

/// Radiance of a matte surface with this normal in world space.
Rgb shade(const glm::dvec3& normal) {
  const double cosine = std::max(glm::dot(normal, kToLight), 0.0);
  return Rgb(static_cast<float>(kAlbedo / std::numbers::pi * kIlluminance * cosine));
}

/// Texel of the 2 × 2 texture at (x, y) of the square, with the texture upright.
const std::array<int, 3>& code_at(double x, double y) { return kCodes[(y < 0 ? 2u : 0u) + (x < 0 ? 0u : 1u)]; }

json mapped(const json& texture) {
  json material = matte_json(static_cast<float>(kAlbedo));
  material["normalTexture"] = texture;
  return material;
}

/// Attributes of the square with normals and, unless empty, one tangent for all corners.
json attributes(Stage& stage, const std::vector<float>& uv, const std::vector<float>& tangent) {
  json result = stage.square(uv);
  result["NORMAL"] = stage.file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  if (tangent.empty()) return result;
  std::vector<float> tangents;
  for (int i = 0; i < 4; ++i) tangents.insert(tangents.end(), tangent.begin(), tangent.end());
  result["TANGENT"] = stage.file.floats(tangents, 4);
  return result;
}

Image shown(Stage& stage, const json& square, const json& texture, const json& node = json::object()) {
  stage.light({{"type", "directional"}, {"intensity", kIlluminance}},
              {{"rotation", rotation_json(kTurnsTheLight, kTilt)}});
  stage.show(square, mapped(texture), node);
  Scene scene = stage.load();
  EXPECT_TRUE(scene.warnings.empty());
  return image(std::move(scene));
}

constexpr double kPrecision = 2e-3;  // for packed normals and tangents, at radiances of about 2

TEST(NormalMap, DerivedTangentFollowsU) {  // green points against increasing v, which is up here
  Stage stage;
  const json texture = stage.texture(2, 2, normal_texels());
  expect_pixels(shown(stage, attributes(stage, kUpright, {}), texture), kPrecision,
                [](double x, double y) { return shade(decoded(code_at(x, y))); });
}

TEST(NormalMap, FlatShadedMeshesHaveTangentsToo) {
  Stage stage;
  const json texture = stage.texture(2, 2, normal_texels());
  expect_pixels(shown(stage, stage.square(), texture), kPrecision,
                [](double x, double y) { return shade(decoded(code_at(x, y))); });
}

TEST(NormalMap, ScaleMultipliesXAndY) {
  Stage stage;
  json texture = stage.texture(2, 2, normal_texels());
  texture["scale"] = 0.4;
  expect_pixels(shown(stage, attributes(stage, kUpright, {}), texture), kPrecision,
                [](double x, double y) { return shade(decoded(code_at(x, y), 0.4)); });
}

TEST(NormalMap, UsesGivenTangents) {  // independent of the texture coordinates: u points up here and w mirrors
  for (const float w : {1.0f, -1.0f}) {
    Stage stage;
    const json texture = stage.texture(2, 2, normal_texels());
    expect_pixels(shown(stage, attributes(stage, kUpright, {0, 1, 0, w}), texture), kPrecision,
                  [w](double x, double y) {
                    const glm::dvec3 n = decoded(code_at(x, y));
                    return shade(n.x * glm::dvec3(0, 1, 0) + n.y * glm::dvec3(-w, 0, 0) + n.z * glm::dvec3(0, 0, 1));
                  });
  }
}

TEST(NormalMap, MirroredCoordinatesMirrorDerivedTangents) {  // u increases to the left
  Stage stage;
  const json texture = stage.texture(2, 2, normal_texels());
  expect_pixels(shown(stage, attributes(stage, {1, 0, 0, 0, 1, 1, 0, 1}, {}), texture), kPrecision,
                [](double x, double y) {
                  const glm::dvec3 n = decoded(code_at(-x, y));
                  return shade({-n.x, n.y, n.z});
                });
}

TEST(NormalMap, MirroringNodesMirrorNormals) {  // the square mirrored twice: inside out, and by a scale of -1
  for (const std::vector<float>& tangent : {std::vector<float>{}, {1, 0, 0, 1}}) {
    Stage stage;
    const json texture = stage.texture(2, 2, normal_texels());
    expect_pixels(shown(stage, attributes(stage, kUpright, tangent), texture, {{"scale", {-1, 1, 1}}}), kPrecision,
                  [](double x, double y) {
                    const glm::dvec3 n = decoded(code_at(-x, y));
                    return shade({-n.x, n.y, n.z});
                  });
  }
}

/// The texture rotated a quarter turn counter-clockwise: u increases upwards on the square, v to the right.
constexpr double kQuarter = std::numbers::pi / 2;
const std::vector<float> kTurned = {1, 0, 1, 1, 0, 0, 0, 1};
Rgb turned(double x, double y) {
  const glm::dvec3 n = decoded(code_at(y, -x));
  return shade(n.x * glm::dvec3(0, 1, 0) + n.y * glm::dvec3(-1, 0, 0) + n.z * glm::dvec3(0, 0, 1));
}

TEST(NormalMap, TurnedCoordinatesTurnDerivedTangents) {
  Stage stage;
  const json texture = stage.texture(2, 2, normal_texels());
  expect_pixels(shown(stage, attributes(stage, kTurned, {}), texture), kPrecision, turned);
}

TEST(NormalMap, DerivedTangentsFollowTheTexturesOwnSet) {  // set 1 is rotated, set 0 is not
  Stage stage;
  json texture = stage.texture(2, 2, normal_texels());
  texture["texCoord"] = 1;
  json square = attributes(stage, kUpright, {});
  square["TEXCOORD_1"] = stage.file.floats(kTurned, 2);
  expect_pixels(shown(stage, square, texture), kPrecision, turned);
}

TEST(NormalMap, DerivedTangentsExistWithTheSecondSetAlone) {
  Stage stage;
  json texture = stage.texture(2, 2, normal_texels());
  texture["texCoord"] = 1;
  json square = attributes(stage, {}, {});
  square["TEXCOORD_1"] = stage.file.floats(kUpright, 2);
  expect_pixels(shown(stage, square, texture), kPrecision,
                [](double x, double y) { return shade(decoded(code_at(x, y))); });
}

TEST(NormalMap, DerivedTangentsFollowTheTexturesTransform) {  // as with transformed coordinates
  Stage stage;
  json texture = stage.texture(2, 2, normal_texels());
  // u' = 1 - v, v' = u: a rotation of -90° and an offset.
  texture["extensions"]["KHR_texture_transform"] = {{"offset", {1, 0}}, {"rotation", -kQuarter}};
  expect_pixels(shown(stage, attributes(stage, kUpright, {}), texture), kPrecision, turned);
}

TEST(NormalMap, GivenTangentsStayUnderATransform) {  // the file's tangents belong to the untransformed map
  Stage stage;
  json texture = stage.texture(2, 2, normal_texels());
  texture["extensions"]["KHR_texture_transform"] = {{"offset", {1, 0}}, {"rotation", -kQuarter}};
  expect_pixels(shown(stage, attributes(stage, kUpright, {0, 1, 0, 1}), texture), kPrecision, turned);
}

}  // namespace
}  // namespace relume::support
