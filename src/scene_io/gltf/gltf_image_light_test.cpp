// Tests EXT_lights_image_based by the environment's radiance in known directions.
#include <gtest/gtest.h>

#include "core/srgb.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::GltfBuilder;
using testing::json;
using testing::mentions;

constexpr int kSize = 16;

/// Face of one colour with a white patch in the upper left quarter.
Bytes face(uint8_t r, uint8_t g, uint8_t b, uint8_t alpha = 255) {
  std::vector<uint8_t> rgba;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const bool patch = x < kSize / 2 && y < kSize / 2;
      for (const uint8_t value : {r, g, b}) rgba.push_back(patch ? 255 : value);
      rgba.push_back(alpha);
    }
  }
  return testing::png(kSize, kSize, rgba);
}

/// Red, green and blue for +X, +Y and +Z; cyan, magenta and yellow for the negative directions.
std::vector<Bytes> faces(uint8_t alpha = 255) {
  return {face(255, 0, 0, alpha),   face(0, 255, 255, alpha), face(0, 255, 0, alpha),
          face(255, 0, 255, alpha), face(0, 0, 255, alpha),   face(255, 255, 0, alpha)};
}

GltfBuilder file_with(const json& light, const std::vector<Bytes>& images = faces()) {
  GltfBuilder file;
  file.add_root({{"mesh", file.add_triangle()}});
  for (const Bytes& image : images) file.add("images", {{"uri", testing::data_uri(image)}});
  file.doc["extensionsUsed"] = file.doc["extensionsRequired"] = json::array({"EXT_lights_image_based"});
  file.doc["extensions"]["EXT_lights_image_based"]["lights"] = json::array({light});
  file.doc["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 0;
  return file;
}

json light(const json& more = json::object()) {
  json result = {{"specularImageSize", kSize}, {"specularImages", json::array({{0, 1, 2, 3, 4, 5}})}};
  result.update(more);
  return result;
}

/// Environment radiance at the nearest texel.
Rgb seen(const Environment& e, const Vec3& w) {
  const Vec3 n = glm::normalize(w);
  const float u = 0.5f + std::atan2(n.x, -n.z) / (2 * kPi);
  const auto x = std::min(e.width - 1, static_cast<int>(u * static_cast<float>(e.width)));
  const auto y = std::min(e.height - 1, static_cast<int>(std::acos(n.y) / kPi * static_cast<float>(e.height)));
  return e.color * e.map[static_cast<size_t>(y) * static_cast<size_t>(e.width) + static_cast<size_t>(x)];
}

void expect_seen(const Environment& e, const Vec3& w, const Rgb& expected) {
  const Rgb value = seen(e, w);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], 1e-3f) << w.x << ' ' << w.y << ' ' << w.z;
}

TEST(GltfImageLight, FacesLieInTheirDirections) {
  const Scene scene = file_with(light()).load();
  EXPECT_TRUE(scene.warnings.empty());
  const Environment& e = scene.environment;
  ASSERT_EQ(e.kind, EnvironmentKind::map);
  EXPECT_EQ(e.width, 2 * e.height);
  // Outside the patch, which is in the upper left quarter seen from inside.
  expect_seen(e, {1, -0.4f, 0.3f}, {1, 0, 0});
  expect_seen(e, {-1, -0.4f, 0.3f}, {0, 1, 1});
  expect_seen(e, {-0.3f, 1, 0.4f}, {0, 1, 0});
  expect_seen(e, {-0.3f, -1, -0.4f}, {1, 0, 1});
  expect_seen(e, {0.3f, -0.4f, 1}, {0, 0, 1});
  expect_seen(e, {0.3f, -0.4f, -1}, {1, 1, 0});
}

TEST(GltfImageLight, FacesAreSeenFromInside) {
  const Environment e = file_with(light()).load().environment;
  const Rgb white(1);
  // Left of the view along each axis, with +Y up.
  expect_seen(e, {1, 0.4f, -0.4f}, white);
  expect_seen(e, {-1, 0.4f, 0.4f}, white);
  expect_seen(e, {0.4f, 0.4f, 1}, white);
  expect_seen(e, {-0.4f, 0.4f, -1}, white);
  expect_seen(e, {0.4f, 1, -0.4f}, white);
  expect_seen(e, {0.4f, -1, 0.4f}, white);
  expect_seen(e, {1, 0.4f, 0.4f}, {1, 0, 0});
}

TEST(GltfImageLight, TurnsAndScales) {
  // A quarter turn about +Y rotates +Z to +X; one about +X rotates +Y to +Z.
  const float h = std::sqrt(0.5f);
  const Environment about_y = file_with(light({{"rotation", {0, h, 0, h}}, {"intensity", 3}})).load().environment;
  expect_seen(about_y, {1, -0.4f, -0.3f}, {0, 0, 3});
  const Environment about_x = file_with(light({{"rotation", {h, 0, 0, h}}})).load().environment;
  expect_seen(about_x, {-0.3f, -0.4f, 1}, {0, 1, 0});
}

TEST(GltfImageLight, AlphaDividesTheColoursOfPngs) {
  const Environment e = file_with(light(), faces(51)).load().environment;
  expect_seen(e, {1, -0.4f, 0.3f}, {5, 0, 0});
}

TEST(GltfImageLight, MidTonesAreDecodedBeforeTheyAreDivided) {
  std::vector<Bytes> images = faces(128);
  images[0] = face(188, 99, 20, 128);
  const Environment e = file_with(light(), images).load().environment;
  const float d = 128.0f / 255;
  expect_seen(e, {1, -0.4f, 0.3f},
              Rgb(linear_from_srgb(188.0f / 255), linear_from_srgb(99.0f / 255), linear_from_srgb(20.0f / 255)) / d);
}

TEST(GltfImageLight, MalformedLightsGiveOneWarning) {
  const Bytes cut(20, std::byte{0x89});
  std::vector<std::pair<json, std::string>> cases = {
      {{{"intensity", 1}}, "it has no specular images"},
      {light({{"specularImages", json::array()}}), "it has no specular images"},
      {light({{"specularImages", json::array({{0, 1, 2}})}}), "does not have six images"},
      {light({{"specularImages", json::array({{0, 1, 2, 3, 4, 99}})}}), "there is no image 99"},
      {light({{"specularImages", json::array({{0, 1, 2, 3, 4, -1}})}}), "there is no image -1"},
      {light({{"specularImages", json::array({{0, 1, 2, 3, 4, "a"}})}}),
       "an entry of its specularImages is not the index of an image"},
      {light({{"specularImages", json::array({{0, 1, 2, 3, 4, 6}})}}), "differ in size"},
      {light({{"specularImages", json::array({{0, 1, 2, 3, 4, 7}})}}), "are not a square"},
      {light({{"specularImages", json::array({{0, 1, 2, 3, 4, 8}})}}), "image 8"},
      {light({{"specularImages", json::array({{0, 1, 2, 3, 4, 9}})}}),
       "4096x4096 pixels are not a square of at most 2048"},
      {json("text"), "it is not an object"},
  };
  std::vector<Bytes> images = faces();
  images.push_back(testing::solid_png(2, 2, 1, 2, 3, 255));
  images.push_back(testing::solid_png(4, 2, 1, 2, 3, 255));
  images.push_back(cut);
  Bytes oversized = face(1, 2, 3);  // with too little data: it is not decoded
  oversized[18] = oversized[22] = std::byte{16};
  oversized[19] = oversized[23] = std::byte{0};
  images.push_back(oversized);
  for (const auto& [broken, sentence] : cases) {
    const Scene scene = file_with(broken, images).load();
    EXPECT_EQ(scene.environment.kind, EnvironmentKind::automatic) << sentence;
    ASSERT_EQ(scene.warnings.size(), 1u) << sentence;
    EXPECT_TRUE(mentions(scene.warnings, "image-based light 0: ")) << scene.warnings[0];
    EXPECT_TRUE(mentions(scene.warnings, sentence)) << scene.warnings[0];
  }
  GltfBuilder file = file_with(light());
  file.doc["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 7;
  EXPECT_TRUE(mentions(file.load().warnings, "image-based light 7: it does not exist; the light is ignored"));
}

}  // namespace
}  // namespace relume
