// Tests texture mapping: KHR_texture_transform, the second set of coordinates, wrapping, levels of detail.
#include <gtest/gtest.h>

#include <cmath>

#include "gltf_features/stage.h"

namespace relume::support {
namespace {

/// A texture of 4 × 4 texels on the square.
json four_by_four(Stage& stage, const json& sampler = json::object()) {
  return stage.texture(4, 4, colorful(4, 4), sampler);
}

/// uv' = offset + R · (scale ⊙ uv) for the corners of the square. R rotates counter-clockwise in the texture, whose v
/// points down.
std::vector<float> moved_corners(const Vec2& offset, float rotation, const Vec2& scale) {
  const double c = std::cos(static_cast<double>(rotation));
  const double s = std::sin(static_cast<double>(rotation));
  std::vector<float> uv;
  for (size_t i = 0; i < kUpright.size(); i += 2) {
    const glm::dvec2 p = glm::dvec2(kUpright[i], kUpright[i + 1]) * glm::dvec2(scale);
    uv.push_back(static_cast<float>(c * p.x + s * p.y) + offset.x);
    uv.push_back(static_cast<float>(c * p.y - s * p.x) + offset.y);
  }
  return uv;
}

/// A KHR_texture_transform against transformed coordinates.
Scene transform(Way way, const Vec2& offset, float rotation, const Vec2& scale) {
  Stage stage;
  json texture = four_by_four(stage);
  if (way == Way::feature) {
    texture["extensions"]["KHR_texture_transform"] = {
        {"offset", {offset.x, offset.y}}, {"rotation", rotation}, {"scale", {scale.x, scale.y}}};
  }
  stage.show(stage.square(way == Way::plain ? moved_corners(offset, rotation, scale) : kUpright), unlit_json(texture));
  return stage.load();
}

/// A scale of 8 makes checkers much smaller than pixels: the selected level shows their mean.
Scene shrunk(Way way) {
  Stage stage;
  std::vector<uint8_t> checkers;
  for (int i = 0; i < 16 * 16; ++i) {
    const uint8_t value = (i % 16 + i / 16) % 2 ? 255 : 0;
    checkers.insert(checkers.end(), {value, value, value, 255});
  }
  json texture = stage.texture(16, 16, checkers);
  if (way == Way::feature) texture["extensions"]["KHR_texture_transform"]["scale"] = {8, 8};
  if (way == Way::plain) {
    texture = stage.texture(1, 1, {188, 188, 188, 255});  // sRGB code of the mean, 0.5
  }
  stage.show(stage.square(), unlit_json(texture));
  return stage.load();
}

/// Material textures select a set of coordinates by `texCoord`, in the texture info or in the transform.
Scene second_set(Way way, bool in_transform) {
  Stage stage;
  json texture = four_by_four(stage);
  json attributes = stage.square(way == Way::plain ? kUpright : std::vector<float>{1, 1, 0, 1, 1, 0, 0, 0});
  if (way == Way::feature) {
    attributes["TEXCOORD_1"] = stage.file.floats(kUpright, 2);
    if (in_transform) {
      texture["extensions"]["KHR_texture_transform"]["texCoord"] = 1;
    } else {
      texture["texCoord"] = 1;
    }
  }
  stage.show(attributes, unlit_json(texture));
  return stage.load();
}

/// The level of detail follows the texture's set of coordinates; set 0 covers the square 64 times.
Scene level_of_second_set(Way way) {
  Stage stage;
  json texture = stage.texture(16, 16, colorful(16, 16));
  std::vector<float> repeated = kUpright;
  for (float& c : repeated) c *= 64;
  json attributes = stage.square(way == Way::plain ? kUpright : repeated);
  if (way == Way::feature) {
    attributes["TEXCOORD_1"] = stage.file.floats(kUpright, 2);
    texture["texCoord"] = 1;
  }
  stage.show(attributes, unlit_json(texture));
  return stage.load();
}

/// Source texel of texel `i` in three periods of a texture of `n` texels, the second of which is the texture itself.
int wrapped(int i, int n, int mode) {
  const int texel = i % n;
  if (mode == 33071) return i < n ? 0 : (i < 2 * n ? texel : n - 1);  // clamp to edge
  return mode == 33648 && i / n != 1 ? n - 1 - texel : texel;         // mirrored repeat, else repeat
}

/// Wrapping beyond [0, 1] against a texture that contains the repetitions.
Scene wrap(Way way, int mode_s, int mode_t) {
  Stage stage;
  const std::vector<uint8_t> texels = colorful(2, 2);
  std::vector<uint8_t> painted;
  for (int i = 0; i < 36; ++i) {
    const int texel = wrapped(i / 6, 2, mode_t) * 2 + wrapped(i % 6, 2, mode_s);
    painted.insert(painted.end(), texels.begin() + 4 * texel, texels.begin() + 4 * texel + 4);
  }
  const bool is_default = way == Way::ignored;
  if (way == Way::plain) {
    stage.show(stage.square(), unlit_json(stage.texture(6, 6, painted)));
  } else {
    const json sampler = {{"wrapS", is_default ? 10497 : mode_s}, {"wrapT", is_default ? 10497 : mode_t}};
    stage.show(stage.square({-1, -1, 2, -1, -1, 2, 2, 2}), unlit_json(stage.texture(2, 2, texels, sampler)));
  }
  return stage.load();
}

const FeatureCase kCases[] = {
    {"TransformOffset",
     [](Way way) {
       return transform(way, {0.3f, -0.15f}, 0, Vec2(1));
     }},
    {"TransformRotation", [](Way way) { return transform(way, Vec2(0), 0.7f, Vec2(1)); }},
    {"TransformScale",
     [](Way way) {
       return transform(way, Vec2(0), 0, {2, -0.5f});
     }},
    {"TransformAll",
     [](Way way) {
       return transform(way, {0.2f, 0.4f}, -1.1f, {1.5f, 0.75f});
     }},
    {"TransformScaleChoosesLevel", shrunk},
    {"TexCoordOne", [](Way way) { return second_set(way, false); }},
    {"TexCoordOneInTransform", [](Way way) { return second_set(way, true); }},
    {"TexCoordOneChoosesLevel", level_of_second_set},
    {"WrapClamp", [](Way way) { return wrap(way, 33071, 33071); }},
    {"WrapMirror", [](Way way) { return wrap(way, 33648, 33648); }},
    {"WrapEachItsOwn", [](Way way) { return wrap(way, 33071, 33648); }},
};

class TextureFeature : public FeatureTest {};
TEST_P(TextureFeature, MatchesPlainScene) { check(); }
INSTANTIATE_TEST_SUITE_P(Gltf, TextureFeature, ::testing::ValuesIn(kCases), feature_name);

TEST(TextureFeatures, TexelsLieWhereGltfPutsThem) {  // (0, 0) is the upper left corner; sRGB codes are decoded
  Stage stage;
  const std::vector<uint8_t> texels = colorful(4, 4);
  stage.show(stage.square(), unlit_json(stage.texture(4, 4, texels)));
  expect_pixels(image(stage.load()), 1e-5, [&](double x, double y) {
    const size_t texel = 4 * (static_cast<size_t>((1 - y) * 2) * 4 + static_cast<size_t>((x + 1) * 2));
    return Rgb(linear_of(texels[texel]), linear_of(texels[texel + 1]), linear_of(texels[texel + 2]));
  });
}

TEST(TextureFeatures, InterpolationIsOfLinearValues) {  // interpolates linear values, not their codes
  Stage stage;
  const json texture = stage.texture(2, 1, {0, 0, 0, 255, 255, 255, 255, 255}, {{"magFilter", 9729}, {"wrapS", 33071}});
  stage.show(stage.square(), unlit_json(texture));
  expect_pixels(image(stage.load(), 16, 64), 0.01, [](double x, double) {  // jitter within a pixel
    return Rgb(static_cast<float>(glm::clamp(0.5 + x, 0.0, 1.0)));
  });
}

}  // namespace
}  // namespace relume::support
