// The image of SVGF from filtered light: lanes and single pixels give the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "techniques/denoise/svgf/svgf.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 77;  // not a multiple of lanes or tiles
constexpr uint32_t kHeight = 21;
constexpr uint32_t kPixels = kWidth * kHeight;

/// Samples and filtered light with black, missing, infinite and negative values among them.
struct FilteredParts {
  FilteredParts() {
    std::mt19937 generator(11);
    std::uniform_real_distribution<float> uniform(-0.5f, 2);
    const auto random = [&] { return Rgb(uniform(generator), uniform(generator), uniform(generator)); };
    for (uint32_t i = 0; i < kPixels; ++i) {
      radiance[i] = random();
      emission[i] = glm::abs(random());
      caustics[i] = random();
      albedo[i] = i % 7 == 0 ? Rgb(0) : glm::abs(random());
      specular_albedo[i] = i % 5 < 2 || i / kWidth == 6 ? Rgb(0) : glm::abs(random());
      if (i % 17 == 0) albedo[i] = Rgb(0, kLeastAlbedo, 0.5f * kLeastAlbedo);
      if (i % 19 == 0) specular_albedo[i] = Rgb(0.5f * kLeastAlbedo);
      if (i % 14 == 7) radiance[i].g = std::numeric_limits<float>::infinity();
      if (i % 21 == 7) radiance[i].r = std::numeric_limits<float>::quiet_NaN();
      allocation[i] = i % 3;
      for (uint32_t c = 0; c < 3; ++c) {
        *image(diffuse).at(c, i % kWidth, i / kWidth) = uniform(generator);
        *image(specular).at(c, i % kWidth, i / kWidth) = uniform(generator);
      }
    }
  }

  static AtrousImage image(std::vector<float>& values) { return {mutable_view_of(values), kWidth, kHeight}; }

  SurfaceLight samples(bool sparse, bool layered) {
    SurfaceLight light;
    light.radiance = view_of(radiance);
    light.albedo = view_of(albedo);
    light.emission = view_of(emission);
    if (sparse) light.allocation = view_of(allocation);
    if (layered) light.caustics = view_of(caustics);
    return light;
  }

  std::vector<Rgb> radiance = std::vector<Rgb>(kPixels);
  std::vector<Rgb> emission = radiance;
  std::vector<Rgb> caustics = radiance;
  std::vector<Rgb> albedo = radiance;
  std::vector<Rgb> specular_albedo = radiance;
  std::vector<uint32_t> allocation = std::vector<uint32_t>(kPixels);
  std::vector<float> diffuse = std::vector<float>(AtrousImage::size(kAtrousChannels, kWidth, kHeight));
  std::vector<float> specular = diffuse;
};

template <typename Kernel>
void run_single(const Kernel& kernel) {
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) kernel(x, y);
  }
}

template <typename Kernel>
void run_tiles(const Kernel& kernel) {
  for (uint32_t y = 0; y < kHeight; y += kTileSize) {
    for (uint32_t x = 0; x < kWidth; x += kTileSize)
      kernel(Tile{x, y, std::min(x + kTileSize, kWidth), std::min(y + kTileSize, kHeight)});
  }
}

bool same_bits(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the bits
  return std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
}

TEST(SvgfPresent, ShowsLanesLikeSinglePixels) {
  FilteredParts parts;
  for (const bool sparse : {false, true}) {
    for (const bool layered : {false, true}) {
      SCOPED_TRACE(::testing::Message() << sparse << layered);
      std::vector<Rgb> single(kPixels, Rgb(-7));
      std::vector<Rgb> tiles(kPixels, Rgb(-8));
      SvgfPresentKernel kernel{parts.samples(sparse, layered), parts.image(parts.diffuse), mutable_view_of(single),
                               kWidth};
      run_single(kernel);
      kernel.shown = mutable_view_of(tiles);
      run_tiles(kernel);
      EXPECT_TRUE(same_bits(single, tiles));
    }
  }
}

TEST(SvgfPresent, ShowsLanesOfBothPartsLikeSinglePixels) {
  FilteredParts parts;
  for (const bool sparse : {false, true}) {
    for (const bool layered : {false, true}) {
      SCOPED_TRACE(::testing::Message() << sparse << layered);
      std::vector<Rgb> single(kPixels, Rgb(-7));
      std::vector<Rgb> tiles(kPixels, Rgb(-8));
      std::vector<Rgb> single_specular = single;
      std::vector<Rgb> tiles_specular = tiles;
      SvgfPresentPartsKernel kernel{{parts.samples(sparse, layered), view_of(parts.specular_albedo)},
                                    parts.image(parts.diffuse),
                                    parts.image(parts.specular),
                                    mutable_view_of(single),
                                    mutable_view_of(single_specular),
                                    kWidth};
      run_single(kernel);
      kernel.shown = mutable_view_of(tiles);
      kernel.shown_specular = mutable_view_of(tiles_specular);
      run_tiles(kernel);
      EXPECT_TRUE(same_bits(single, tiles));
      EXPECT_TRUE(same_bits(single_specular, tiles_specular));
    }
  }
}

/// The pass filters no specular light while nothing reflects: its planes may be empty.
TEST(SvgfPresent, ReadsNoSpecularPlanesWithoutReflections) {
  FilteredParts parts;
  std::fill(parts.specular_albedo.begin(), parts.specular_albedo.end(), Rgb(0));
  std::vector<Rgb> shown(kPixels);
  std::vector<Rgb> shown_specular(kPixels, Rgb(1));
  const SvgfPresentPartsKernel kernel{{parts.samples(false, false), view_of(parts.specular_albedo)},
                                      parts.image(parts.diffuse),
                                      {{}, kWidth, kHeight},
                                      mutable_view_of(shown),
                                      mutable_view_of(shown_specular),
                                      kWidth};
  run_tiles(kernel);
  EXPECT_EQ(shown_specular, std::vector<Rgb>(kPixels, Rgb(0)));
}

}  // namespace
}  // namespace relume
