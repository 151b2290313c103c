#include "techniques/denoise/shared/split_light.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace relume {
namespace {

TEST(SplitLight, SplitsLanesLikeSinglePixels) {
  constexpr uint32_t kWidth = 29;  // not a multiple of lanes
  std::mt19937 generator(7);
  std::uniform_real_distribution<float> uniform(0, 2);
  const auto random = [&] { return Rgb(uniform(generator), uniform(generator), uniform(generator)); };
  std::vector<Rgb> scattered(kWidth);
  std::vector<Rgb> found(kWidth);
  std::vector<Rgb> diffuse_albedo(kWidth);
  std::vector<Rgb> specular_albedo(kWidth);
  for (uint32_t i = 0; i < kWidth; ++i) {
    scattered[i] = random();
    found[i] = random();
    diffuse_albedo[i] = i % 3 == 0 ? Rgb(0) : random();
    specular_albedo[i] = i % 5 < 2 ? Rgb(0) : random();
  }
  std::vector<Rgb> diffuse(2 * kWidth);
  std::vector<Rgb> specular(2 * kWidth);
  const auto kernel_at = [&](uint32_t first) {
    return SplitLightKernel{view_of(scattered),
                            view_of(found),
                            view_of(diffuse_albedo),
                            view_of(specular_albedo),
                            {&diffuse[first], kWidth},
                            {&specular[first], kWidth},
                            kWidth};
  };
  const SplitLightKernel single = kernel_at(0);
  for (uint32_t x = 0; x < kWidth; ++x) single(x, 0);
  kernel_at(kWidth)(Tile{0, 0, kWidth, 1});
  for (uint32_t x = 0; x < kWidth; ++x) {
    EXPECT_EQ(diffuse[x], diffuse[kWidth + x]) << x;
    EXPECT_EQ(specular[x], specular[kWidth + x]) << x;
  }
}

}  // namespace
}  // namespace relume
