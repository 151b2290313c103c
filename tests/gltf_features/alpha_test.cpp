// Tests alpha modes and vertex colours.
#include <gtest/gtest.h>

#include <algorithm>

#include "gltf_features/stage.h"

namespace relume::support {
namespace {

/// Texture columns with these alphas and colour code 255.
json alphas(Stage& stage, const std::vector<int>& values) {
  std::vector<uint8_t> texels;
  for (const int alpha : values) texels.insert(texels.end(), {255, 255, 255, static_cast<uint8_t>(alpha)});
  return stage.texture(static_cast<int>(values.size()), 1, texels);
}

/// Columns of the square with alphas 255, 100, 140 and 0 and base colour (0.5, 0.25, 0.125, `factor`), in uniform light
/// of radiance 1.
Image columns(const json& mode, float factor, int spp) {
  Stage stage;
  json material = unlit_json(alphas(stage, {255, 100, 140, 0}), {0.5, 0.25, 0.125, factor});
  material.update(mode);
  stage.show(stage.square(), material);
  return image(stage.load(1), 16, spp);
}

/// Colour with this share covered by the card.
Rgb covered(float share) { return Rgb(1) + share * (Rgb(0.5f, 0.25f, 0.125f) - Rgb(1)); }

size_t column_of(double x) { return static_cast<size_t>((x + 1) * 2); }

TEST(Alpha, OpaqueIgnoresAlpha) {
  expect_pixels(columns({{"alphaMode", "OPAQUE"}}, 0.5f, 4), 1e-5, [](double, double) { return covered(1); });
  expect_pixels(columns(json::object(), 0.5f, 4), 1e-5, [](double, double) { return covered(1); });
}

TEST(Alpha, MaskCutsAtHalf) {
  expect_pixels(columns({{"alphaMode", "MASK"}}, 1, 4), 1e-5, [](double x, double) {
    constexpr float kCovered[] = {1, 0, 1, 0};
    return covered(kCovered[column_of(x)]);
  });
}

TEST(Alpha, MaskUsesTheGivenCutoff) {  // 0.8 · (1, 0.39, 0.55, 0) against 0.3
  expect_pixels(columns({{"alphaMode", "MASK"}, {"alphaCutoff", 0.3}}, 0.8f, 4), 1e-5, [](double x, double) {
    constexpr float kCovered[] = {1, 1, 1, 0};
    return covered(kCovered[column_of(x)]);
  });
}

TEST(Alpha, BlendMixes) {
  // Each sample is a random decision: 1,024 of them have a standard deviation of at most 1.4 % of the difference.
  expect_pixels(columns({{"alphaMode", "BLEND"}}, 0.8f, 1024), 0.05, [](double x, double) {
    constexpr float kAlpha[] = {255, 100, 140, 0};
    return covered(0.8f * kAlpha[column_of(x)] / 255);
  });
}

/// Square with these RGBA corner colours, in reading order.
Image colored(const std::vector<float>& rgba, const json& material, float environment, int spp) {
  Stage stage;
  json attributes = stage.square();
  attributes["COLOR_0"] = stage.file.floats(rgba, 4);
  stage.show(attributes, material);
  return image(stage.load(environment), 16, spp);
}

TEST(VertexColor, InterpolatesLinearly) {  // linear values, not sRGB
  // Red increases to the right and green upwards, so that both triangles agree on the plane.
  const Image image =
      colored({0, 1, 0.5f, 1, 1, 1, 0.5f, 1, 0, 0, 0.5f, 1, 1, 0, 0.5f, 1}, unlit_json({}, {0.5, 1, 1, 1}), 0, 64);
  expect_pixels(image, 0.01, [](double x, double y) {  // jitter within a pixel
    return Rgb(static_cast<float>(0.25 * (x + 1)), static_cast<float>(0.5 * (y + 1)), 0.5f);
  });
}

TEST(VertexColor, AlphaBlends) {
  json material = unlit_json();
  material["alphaMode"] = "BLEND";
  std::vector<float> corners;
  for (int i = 0; i < 4; ++i) corners.insert(corners.end(), {0, 0.5f, 1, 0.25f});
  const Image image = colored(corners, material, 1, 1024);
  expect_pixels(image, 0.05, [](double, double) { return Rgb(0.75f) + 0.25f * Rgb(0, 0.5f, 1); });
}

TEST(VertexColor, IsLimitedToOneAtEveryVertex) {  // glTF 2.0, §3.7.2.1: clamped before interpolation
  std::vector<float> corners = {-3, 1, 0.5f, 1, 4, 1, 0.5f, 1, -3, -2, 0.5f, 1, 4, -2, 0.5f, 1};
  std::vector<float> limited = corners;
  for (float& c : limited) c = std::clamp(c, 0.0f, 1.0f);
  expect_same(colored(corners, unlit_json(), 0, 4), colored(limited, unlit_json(), 0, 4), 1e-5);
}

/// Equal colours as floats or as normalised integers.
template <typename T>
Scene integer_colors(Way way, int component_type, int largest) {
  Stage stage;
  json attributes = stage.square();
  std::vector<T> codes;
  std::vector<float> values;
  for (int i = 0; i < 12; ++i) {
    codes.push_back(static_cast<T>(i * 5 % 11 * largest / 10));
    values.push_back(static_cast<float>(codes.back()) / static_cast<float>(largest));
  }
  // Three 8-bit components need padding, so that vertices are aligned to four bytes.
  if (way == Way::plain) attributes["COLOR_0"] = stage.file.floats(values, 3);
  if (way == Way::feature) {
    std::vector<T> padded;
    for (size_t i = 0; i < 12; ++i) {
      padded.push_back(codes[i]);
      if (i % 3 == 2) padded.push_back(T{77});
    }
    const int view = stage.file.view(padded);
    stage.file.doc["bufferViews"][static_cast<size_t>(view)]["byteStride"] = 4 * sizeof(T);
    attributes["COLOR_0"] = stage.file.add_accessor(view, 4, 3, component_type, true);
  }
  stage.show(attributes, unlit_json());
  return stage.load();
}

const FeatureCase kCases[] = {
    {"UnsignedByte", [](Way way) { return integer_colors<uint8_t>(way, 5121, 255); }},
    {"UnsignedShort", [](Way way) { return integer_colors<uint16_t>(way, 5123, 65535); }},
};

class VertexColorFeature : public FeatureTest {};
TEST_P(VertexColorFeature, MatchesPlainScene) { check(); }
INSTANTIATE_TEST_SUITE_P(Gltf, VertexColorFeature, ::testing::ValuesIn(kCases), feature_name);

}  // namespace
}  // namespace relume::support
