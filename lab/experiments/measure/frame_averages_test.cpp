#include "experiments/measure/frame_averages.h"

#include <gtest/gtest.h>

#include "testing/random.h"

namespace relume {
namespace {

/// Pixels of mean 1 plus deviations: one shared by a repetition's frames, one independent per frame.
std::vector<FrameSums> sums_of(int repetitions, int frames, float shared, float own, uint32_t seed) {
  testing::Random random(seed);
  const auto spread = [&](float width) { return width * (2 * random.next() - 1); };  // variance width² / 3
  std::vector<FrameSums> list(static_cast<size_t>(repetitions));
  for (FrameSums& sums : list) {
    Image base(32, 32);
    for (Rgb& p : base.pixels) p = Rgb(1 + spread(shared));
    for (int f = 0; f < frames; ++f) {
      Image image = base;
      for (Rgb& p : image.pixels) p += Rgb(spread(own));
      sums.add(image);
    }
  }
  return list;
}

TEST(FrameVariance, IncludesNoiseSharedByFramesOfASession) {
  const PixelMask all = mask_of({"image"}, 32, 32);
  // Ten thousand values determine a variance to a few per cent.
  EXPECT_NEAR(frame_variance(sums_of(6, 8, 0, 0.3f, 1), all).value, 0.03, 0.002);
  EXPECT_NEAR(frame_variance(sums_of(6, 8, 0.3f, 0, 2), all).value, 0.03, 0.002);
  const Estimate both = frame_variance(sums_of(6, 8, 0.3f, 0.3f, 3), all);
  EXPECT_NEAR(both.value, 0.06, 0.003);
  EXPECT_NEAR(both.value, 0.06, 1.5 * both.half_width());
}

TEST(FrameVariance, IsThatOfTheRegion) {
  PixelMask left = mask_of({"image"}, 32, 32);
  for (size_t p = 0; p < left.mask.size(); ++p) left.mask[p] = p % 32 < 16 ? 1 : 0;
  std::vector<FrameSums> sums = sums_of(6, 8, 0, 0.3f, 4);
  for (FrameSums& s : sums) {
    for (size_t p = 0; p < s.values.size(); ++p) {
      if (left.mask[p] == 0) s.squares[p] = 1e9;
    }
  }
  EXPECT_NEAR(frame_variance(sums, left).value, 0.03, 0.003);
}

}  // namespace
}  // namespace relume
