#include "techniques/accumulate/accumulate.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "testing/random.h"

namespace relume {
namespace {

TEST(Accumulate, SumsEveryPixelByItself) {
  std::vector<Rgb> radiance{Rgb(1, 2, 3), Rgb(0), Rgb(0.5f), Rgb(4, 0, 0)};
  std::vector<Rgb> sum(4, Rgb(1));
  std::vector<float> squares(4, 0.0f);
  std::vector<uint32_t> frame_rays{1, 2, 3, 4};
  std::vector<uint32_t> rays(4, 10);
  std::vector<uint32_t> nonfinite(4, 0);
  const AccumulateKernel kernel{view_of(radiance),
                                view_of(frame_rays),
                                mutable_view_of(sum),
                                mutable_view_of(squares),
                                mutable_view_of(rays),
                                mutable_view_of(nonfinite),
                                2};
  for (uint32_t y = 0; y < 2; ++y) {
    for (uint32_t x = 0; x < 2; ++x) kernel(x, y);
  }
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(sum[i], Rgb(1) + radiance[i]);
    EXPECT_FLOAT_EQ(squares[i], sqr(luminance(radiance[i])));
    EXPECT_EQ(rays[i], 10 + frame_rays[i]);
    EXPECT_EQ(nonfinite[i], 0u);
  }
}

TEST(Accumulate, CountsSamplesThatAreNotFiniteAndTakesThemAsBlack) {
  std::vector<Rgb> radiance{Rgb(std::numeric_limits<float>::quiet_NaN()), Rgb(kInfinity)};
  std::vector<Rgb> sum(2, Rgb(1));
  std::vector<float> squares(2, 0.5f);
  std::vector<uint32_t> frame_rays{1, 1};
  std::vector<uint32_t> rays(2, 0);
  std::vector<uint32_t> nonfinite(2, 0);
  const AccumulateKernel kernel{view_of(radiance),
                                view_of(frame_rays),
                                mutable_view_of(sum),
                                mutable_view_of(squares),
                                mutable_view_of(rays),
                                mutable_view_of(nonfinite),
                                2};
  kernel(0, 0);
  kernel(1, 0);
  EXPECT_EQ(nonfinite, (std::vector<uint32_t>{1, 1}));
  EXPECT_EQ(sum[0], Rgb(1));
  EXPECT_EQ(squares[1], 0.5f);
}

TEST(Accumulate, VarianceOfTheMeanMatchesItsDefinition) {
  // Grey values 1, 2, 3, 6: mean 3, unbiased variance 14/3, of the mean 14/12.
  const float values[] = {1, 2, 3, 6};
  Rgb sum(0);
  float squares = 0;
  for (const float v : values) {
    sum += Rgb(v);
    squares += sqr(luminance(Rgb(v)));
  }
  EXPECT_NEAR(variance_of_mean(sum, squares, 4), 14.0 / 12.0, 1e-5);
}

TEST(Accumulate, VarianceIsUnbiased) {
  // Mean over many pixels of the estimate from 8 uniform numbers, against 1/12/8.
  testing::Random random(81);
  double mean = 0;
  constexpr int kPixels = 20000;
  for (int p = 0; p < kPixels; ++p) {
    Rgb sum(0);
    float squares = 0;
    for (int i = 0; i < 8; ++i) {
      const Rgb value(random.next());
      sum += value;
      squares += sqr(luminance(value));
    }
    mean += variance_of_mean(sum, squares, 8) / kPixels;
  }
  EXPECT_NEAR(mean * 96.0, 1.0, 0.02);  // the estimates spread by 0.45 of their mean: five standard errors are 0.016
}

TEST(Accumulate, VarianceNeedsTwoSamples) {
  EXPECT_EQ(variance_of_mean(Rgb(1), 1.0f, 1), 0.0f);
  EXPECT_EQ(variance_of_mean(Rgb(0), 0.0f, 0), 0.0f);
  EXPECT_EQ(variance_of_mean(Rgb(3), 3.0f * sqr(luminance(Rgb(1))), 3), 0.0f);  // all equal
}

}  // namespace
}  // namespace relume
