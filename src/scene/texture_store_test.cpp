// Texture look-ups compared with values computed by hand.
#include "scene/texture_store.h"

#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/srgb.h"
#include "scene/testing/light_scene.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::float_texture;
using testing::Random;

TextureStore store(Texture texture) {
  const std::vector<Texture> list{std::move(texture)};
  return TextureStore(list, TextureFilter::linear);
}

/// 4 × 2 texels with red = 10 y + x.
Texture numbered(WrapMode wrap_u, WrapMode wrap_v) {
  std::vector<Vec4> texels;
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) texels.emplace_back(static_cast<float>(10 * y + x), 0, 0, 1);
  }
  Texture t = float_texture(4, 2, texels);
  t.wrap_u = wrap_u;
  t.wrap_v = wrap_v;
  return t;
}

TEST(Texture, BilinearMatchesTheHand) {
  const TextureStore s = store(numbered(WrapMode::repeat, WrapMode::clamp));
  const auto red = [&](float x, float y) { return s[0].sample_level({x / 4, y / 2}, 0).x; };
  EXPECT_NEAR(red(0.5f, 0.5f), 0, 1e-5f);  // a texel's centre has its value
  EXPECT_NEAR(red(2.5f, 1.5f), 12, 1e-5f);
  EXPECT_NEAR(red(1.0f, 0.5f), 0.5f, 1e-5f);
  EXPECT_NEAR(red(1.75f, 1.0f), 0.75f * 6 + 0.25f * 5 + 0.5f,
              1e-4f);  // between columns 1 and 2 at 1.25: mean of rows is 5 + x
}

TEST(Texture, WrapsByMode) {
  const auto red = [](WrapMode wrap, float x) {
    return store(numbered(wrap, WrapMode::clamp))[0].sample_level({x / 4, 0.25f}, 0).x;
  };
  EXPECT_NEAR(red(WrapMode::repeat, 0.0f), 1.5f, 1e-5f);  // half of column 3, half of column 0
  EXPECT_NEAR(red(WrapMode::repeat, 4.5f), 0, 1e-5f);
  EXPECT_NEAR(red(WrapMode::repeat, -0.5f), 3, 1e-5f);
  EXPECT_NEAR(red(WrapMode::clamp, 0.0f), 0, 1e-5f);
  EXPECT_NEAR(red(WrapMode::clamp, 9.0f), 3, 1e-5f);
  EXPECT_NEAR(red(WrapMode::clamp, -9.0f), 0, 1e-5f);
  EXPECT_NEAR(red(WrapMode::mirror, 4.5f), 3, 1e-5f);
  EXPECT_NEAR(red(WrapMode::mirror, 5.5f), 2, 1e-5f);
  EXPECT_NEAR(red(WrapMode::mirror, -0.5f), 0, 1e-5f);
  EXPECT_NEAR(red(WrapMode::mirror, -1.5f), 1, 1e-5f);
}

TEST(Texture, NearestTakesTheContainingTexel) {
  Texture t = numbered(WrapMode::repeat, WrapMode::clamp);
  t.filter = FilterMode::nearest;
  const TextureStore s = store(t);
  for (int x = 0; x < 4; ++x) {
    for (const float inside : {0.01f, 0.5f, 0.99f})
      EXPECT_EQ(s[0].sample_level({(static_cast<float>(x) + inside) / 4, 0.75f}, 0).x, 10.0f + static_cast<float>(x));
  }
}

TEST(Texture, SurvivesWildCoordinates) {
  for (const WrapMode wrap : {WrapMode::repeat, WrapMode::clamp, WrapMode::mirror}) {
    const TextureStore s = store(numbered(wrap, wrap));
    for (const float u : {-1e9f, 1e9f, 0.99999994f, kInfinity, std::nanf("")}) {
      EXPECT_TRUE(is_finite(s.view().sample(0, {u, u}, 0).x));
      EXPECT_TRUE(is_finite(s.view().sample(0, {u, u}, 50).x));
    }
  }
}

TEST(Texture, DecodesSrgbButNotAlpha) {
  Texture t;
  t.width = t.height = 1;
  t.format = PixelFormat::rgba8_srgb;
  t.texels = {std::byte{188}, std::byte{0}, std::byte{255}, std::byte{128}};
  const Vec4 c = store(t)[0].sample_level(Vec2(0.5f), 0);
  EXPECT_NEAR(srgb_from_linear(c.x) * 255.0f, 188.0f, 0.01f);
  EXPECT_EQ(c.y, 0.0f);
  EXPECT_NEAR(c.z, 1.0f, 1e-6f);
  EXPECT_NEAR(c.w, 128.0f / 255.0f, 1e-6f);
}

double mean_of_level(const TextureSampler& t, int level) {
  double sum = 0;
  for (int y = 0; y < t.record().level_height(level); ++y) {
    for (int x = 0; x < t.record().level_width(level); ++x) sum += t.texel(level, x, y).x;
  }
  return sum / (t.record().level_width(level) * t.record().level_height(level));
}

TEST(Texture, LevelsKeepTheMean) {
  for (const IVec2 size : {IVec2(16, 16), IVec2(32, 8), IVec2(1, 64), IVec2(7, 5), IVec2(37, 100), IVec2(3, 3)}) {
    std::vector<Vec4> texels;
    for (int i = 0; i < size.x * size.y; ++i)
      texels.emplace_back(to_unit_float(hash(static_cast<uint32_t>(i))), 0, 0, 1);
    const TextureStore s = store(float_texture(size.x, size.y, texels));
    const int last = s[0].record().level_count - 1;
    EXPECT_EQ(s[0].record().level_width(last) * s[0].record().level_height(last), 1);
    for (int level = 1; level <= last; ++level) {
      EXPECT_NEAR(mean_of_level(s[0], level), mean_of_level(s[0], 0), 1e-5)
          << size.x << 'x' << size.y << ", level " << level;
    }
  }
}

Texture random_floats(int width, int height) {
  Random random(7);
  std::vector<Vec4> texels;
  for (int i = 0; i < width * height; ++i)
    texels.emplace_back(6 * random.next(), random.next(), 1e-3f * random.next(), random.next());
  return float_texture(width, height, texels);
}

Texture random_codes(int width, int height, PixelFormat format) {
  Random random(8);
  Texture t;
  t.width = width;
  t.height = height;
  t.format = format;
  for (int i = 0; i < 4 * width * height; ++i) t.texels.push_back(static_cast<std::byte>(random.next_bits() >> 24));
  return t;
}

/// The stored value of linear light, whose square root is rounded to 12 bits.
float rounded_to_srgb(float linear) {
  const float root = (std::floor(std::sqrt(linear) * 4095.99f) + 0.5f) / 4096.0f;
  return linear_from_srgb(static_cast<float>(quantise_unorm8(srgb_from_linear(sqr(root)))) / 255.0f);
}
float rounded_to_unorm(float x) { return static_cast<float>(quantise_unorm8(x)) * (1.0f / 255.0f); }

Vec4 rounded(const Vec4& mean, PixelFormat format) {
  if (format == PixelFormat::rgba32_float) return mean;
  const auto color = format == PixelFormat::rgba8_srgb ? rounded_to_srgb : rounded_to_unorm;
  return {color(mean.x), color(mean.y), color(mean.z), rounded_to_unorm(mean.w)};
}

/// Quarters are exact, so the order of the sum decides all bits. It is that of other sizes, whose texels are weighted.
TEST(Texture, LevelsOfEvenSizeHaveTheBitsOfMeansOfFour) {
  for (const Texture& texture : {random_floats(24, 16), random_codes(24, 16, PixelFormat::rgba8_srgb),
                                 random_codes(24, 16, PixelFormat::rgba8_linear)}) {
    const TextureStore s = store(texture);
    for (int level = 1; level <= 3; ++level) {  // 12 × 8, 6 × 4, 3 × 2
      for (int y = 0; y < s[0].record().level_height(level); ++y) {
        for (int x = 0; x < s[0].record().level_width(level); ++x) {
          const auto quarter = [&](int i, int j) { return s[0].texel(level - 1, 2 * x + i, 2 * y + j) * 0.25f; };
          const Vec4 mean = quarter(0, 0) + quarter(1, 0) + quarter(0, 1) + quarter(1, 1);
          EXPECT_EQ(s[0].texel(level, x, y), rounded(mean, texture.format)) << level << ": " << x << ", " << y;
        }
      }
    }
  }
}

/// Host memory whose blocks begin with other bytes each time.
class DirtyMemory final : public Memory {
 public:
  void* allocate(size_t bytes, size_t alignment) override {
    void* const block = host_memory().allocate(bytes, alignment);
    std::memset(block, ++byte_, bytes);
    return block;
  }
  void deallocate(void* block, size_t bytes, size_t alignment) noexcept override {
    host_memory().deallocate(block, bytes, alignment);
  }

 private:
  int byte_ = 0;
};

/// Also in the blocks that a level does not fill.
TEST(Texture, EqualTexturesHaveEqualBytes) {
  DirtyMemory memory;
  for (const IVec2 size : {IVec2(7, 5), IVec2(24, 16), IVec2(1, 9), IVec2(4, 4)}) {
    const std::vector<Texture> list{random_floats(size.x, size.y),
                                    random_codes(size.x, size.y, PixelFormat::rgba8_srgb)};
    const TextureStore a(list, TextureFilter::linear, memory);
    const TextureStore b(list, TextureFilter::linear, memory);
    a.open_for_host();
    b.open_for_host();
    const View<const TexelBytes> of_a = a.view().texels;
    const View<const TexelBytes> of_b = b.view().texels;
    ASSERT_EQ(of_a.size, of_b.size);
    EXPECT_EQ(std::memcmp(of_a.data, of_b.data, size_t{of_a.size} * sizeof(TexelBytes)), 0) << size.x << 'x' << size.y;
  }
}

TEST(Texture, DitheredLevelHasTheTrilinearMean) {
  const TextureStore s = store(testing::noise_texture(16));
  Random random(96);
  for (const float lod : {0.3f, 1.5f, 2.75f}) {
    double dithered = 0;
    double trilinear = 0;
    constexpr int kSamples = 200000;
    const int level = static_cast<int>(lod);
    const float t = lod - std::floor(lod);
    for (int i = 0; i < kSamples; ++i) {
      const Vec2 uv = random.next_2d();
      dithered += s.view().sample(0, uv, lod).x / kSamples;
      trilinear += ((1 - t) * s[0].sample_level(uv, level).x + t * s[0].sample_level(uv, level + 1).x) / kSamples;
    }
    EXPECT_NEAR(dithered / trilinear, 1.0, 0.01);  // the standard deviation of the levels is about one: 5/√200000
  }
  EXPECT_EQ(s.view().sample(0, {0.3f, 0.4f}, -1).x, s[0].sample_level({0.3f, 0.4f}, 0).x);
  EXPECT_EQ(s.view().sample(0, {0.3f, 0.4f}, 99).x, s[0].sample_level({0.3f, 0.4f}, s[0].record().level_count - 1).x);
}

}  // namespace
}  // namespace relume
