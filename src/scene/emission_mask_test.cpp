#include "scene/emission_mask.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/hash.h"
#include "scene/scene.h"
#include "scene/texture_store.h"

namespace relume {
namespace {

/// A texture with only a few non-black texels.
Texture sparse(int width, int height, WrapMode wrap, FilterMode filter) {
  Texture t{"sparse", width, height, PixelFormat::rgba8_srgb, wrap, wrap, filter, {}, {}};
  const size_t count = static_cast<size_t>(width) * static_cast<size_t>(height);
  t.texels.assign(4 * count, std::byte{0});
  for (const size_t texel : {size_t{0}, count / 2, count - 1}) t.texels[4 * texel] = std::byte{9};
  return t;
}

Vec2 random_uv(uint32_t triangle, uint32_t corner, float extent) {
  const auto random = [&](uint32_t a, uint32_t b) { return to_unit_float(hash(triangle, a, b)); };
  const Vec2 middle(3.0f * random(9, 0) - 1.5f, 3.0f * random(9, 1) - 1.5f);
  return middle + extent * Vec2(random(corner, 2) - 0.5f, random(corner, 3) - 0.5f);
}

/// Whether a look-up inside the triangle is non-black.
bool emits(const TextureSampler& texture, const Vec2 (&uv)[3]) {
  constexpr int kSteps = 24;
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; i + k <= kSteps; ++k) {
      const Vec2 b(static_cast<float>(i) / kSteps, static_cast<float>(k) / kSteps);
      const Vec2 at = uv[0] * (1.0f - b.x - b.y) + uv[1] * b.x + uv[2] * b.y;
      if (!is_black(Rgb(texture.sample_level(at, 0)))) return true;
    }
  }
  return false;
}

TEST(EmissionMask, MissesNoLightAndFindsBlackTriangles) {
  int black = 0;
  for (const WrapMode wrap : {WrapMode::repeat, WrapMode::mirror, WrapMode::clamp}) {
    for (const FilterMode filter : {FilterMode::linear, FilterMode::nearest}) {
      for (const auto& [width, height] : {std::array{1, 1}, std::array{7, 3}, std::array{32, 16}}) {
        const std::vector<Texture> textures{sparse(width, height, wrap, filter)};
        const TextureStore store(textures, TextureFilter::linear);
        const EmissionMask mask(store[0]);
        for (uint32_t i = 0; i < 200; ++i) {
          const float extent = i % 2 == 0 ? 0.05f : 0.6f;
          const Vec2 uv[3] = {random_uv(i, 0, extent), random_uv(i, 1, extent), random_uv(i, 2, extent)};
          const bool may_emit = mask.may_emit(uv);
          if (emits(store[0], uv)) {
            EXPECT_TRUE(may_emit) << i;
          }
          black += may_emit ? 0 : 1;
        }
      }
    }
  }
  EXPECT_GT(black, 300);
}

TEST(EmissionMask, CoordinatesThatAreNotFiniteMayEmit) {
  const std::vector<Texture> textures{sparse(8, 8, WrapMode::repeat, FilterMode::linear)};
  const TextureStore store(textures, TextureFilter::linear);
  const EmissionMask mask(store[0]);
  for (const float u : {kInfinity, std::nanf(""), 1e30f}) {
    const Vec2 uv[3] = {Vec2(u, 0), Vec2(0), Vec2(1)};
    EXPECT_TRUE(mask.may_emit(uv)) << u;
  }
}

}  // namespace
}  // namespace relume
