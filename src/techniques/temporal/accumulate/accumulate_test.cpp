#include "techniques/temporal/accumulate/accumulate.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "framebuffer/testing/moment_vectors.h"
#include "techniques/temporal/accumulate/accumulate_pass.h"
#include "testing/random.h"

namespace relume {
namespace {

/// The buffers of `n` pixels in a row.
struct Pixels {
  explicit Pixels(size_t n) : radiance(n, Rgb(0)), rays(n, 1), moments(n), ray_sum(n, 0), nonfinite(n, 0) {}

  AccumulateKernel kernel() {
    AccumulateKernel k;
    k.radiance = view_of(radiance);
    k.rays = view_of(rays);
    k.allocation = view_of(allocation);
    k.history = moments.view();
    k.moments = moments.mutable_view();
    k.ray_sum = mutable_view_of(ray_sum);
    k.nonfinite = mutable_view_of(nonfinite);
    k.width = static_cast<uint32_t>(radiance.size());
    return k;
  }
  void add(uint32_t pixel, const Rgb& value) {
    radiance[pixel] = value;
    kernel()(pixel, 0);
  }

  std::vector<Rgb> radiance;
  std::vector<uint32_t> rays;
  std::vector<uint32_t> allocation;
  testing::MomentVectors moments;
  std::vector<uint32_t> ray_sum;
  std::vector<uint32_t> nonfinite;
};

TEST(Accumulate, AveragesPixelsIndependently) {
  Pixels p(2);
  p.rays = {3, 5};
  p.add(0, Rgb(1, 2, 3));
  p.add(0, Rgb(3, 0, 3));
  p.add(1, Rgb(7));
  EXPECT_EQ(p.moments.mean[0], Rgb(2, 1, 3));
  EXPECT_EQ(p.moments.mean[1], Rgb(7));
  EXPECT_EQ(p.moments.samples, (std::vector<uint32_t>{2, 1}));
  EXPECT_EQ(p.ray_sum, (std::vector<uint32_t>{6, 5}));
}

TEST(Accumulate, CountsNonFiniteSamplesAsBlack) {
  Pixels p(2);
  p.add(0, Rgb(4));
  p.add(0, Rgb(std::numeric_limits<float>::quiet_NaN()));
  p.add(1, Rgb(kInfinity));
  EXPECT_EQ(p.nonfinite, (std::vector<uint32_t>{1, 1}));
  EXPECT_EQ(p.moments.mean[0], Rgb(2));
  EXPECT_EQ(p.moments.mean[1], Rgb(0));
}

TEST(Accumulate, KeepsPixelsWithoutSamples) {
  Pixels p(2);
  p.allocation = {0, 1};
  p.add(0, Rgb(4));
  p.add(1, Rgb(4));
  EXPECT_EQ(p.moments.samples, (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(p.moments.mean[0], Rgb(0));
}

TEST(Accumulate, WithoutHistoryShowsTheLatestSample) {
  Pixels p(1);
  p.add(0, Rgb(4));
  p.radiance[0] = Rgb(1);
  AccumulateKernel kernel = p.kernel();
  kernel.keep = false;
  kernel(0, 0);
  EXPECT_EQ(p.moments.mean[0], Rgb(1));
  EXPECT_EQ(p.moments.samples[0], 1u);
  EXPECT_EQ(p.moments.m2[0], 0.0f);
}

TEST(Accumulate, ContinuesItsHistory) {
  Pixels p(2);
  testing::MomentVectors history(2, {Rgb(2), 1, 3, 3});
  p.radiance = {Rgb(6), Rgb(6)};
  p.allocation = {1, 0};
  AccumulateKernel kernel = p.kernel();
  kernel.history = history.view();
  for (const uint32_t pixel : {0u, 1u}) kernel(pixel, 0);
  EXPECT_EQ(p.moments.mean, (std::vector<Rgb>{Rgb(3), Rgb(2)})) << "the second pixel got no sample";
  EXPECT_EQ(p.moments.samples, (std::vector<uint32_t>{4, 3}));
  EXPECT_EQ(p.moments.m2, (std::vector<float>{1 + 4 * 3, 1}));
  EXPECT_EQ(history.mean[0], Rgb(2));
}

TEST(Accumulate, RelativeErrorIsThatOfTheMeans) {
  Pixels p(2);
  Backend backend(2);
  PrimitiveScratch scratch;
  const auto error = [&] {
    return relative_error({backend, "error", scratch}, {p.moments.view(), {}, {0, 0, 2, 1}, 2});
  };
  for (const float value : {1.0f, 3.0f}) {
    EXPECT_TRUE(std::isinf(error()));
    p.add(0, Rgb(value));
    p.add(1, Rgb(2));
  }
  // Means 2 and 2; variances of the means ((1² + 1²) / 1) / 2 = 1 and 0.
  EXPECT_NEAR(error(), std::sqrt(0.5) / 2, 1e-6);
  Pixels black(1);
  for (int i = 0; i < 2; ++i) black.add(0, Rgb(0));
  EXPECT_EQ(relative_error({backend, "error", scratch}, {black.moments.view(), {}, {0, 0, 1, 1}, 1}), 0);
}

TEST(Accumulate, RelativeErrorOfAWindowIgnoresOtherPixels) {
  Pixels p(6);  // two rows of three pixels
  for (const float value : {1.0f, 3.0f}) {
    for (const uint32_t pixel : {1u, 2u, 4u, 5u}) p.add(pixel, Rgb(pixel == 5 ? value : 2.0f));
  }
  Backend backend(2);
  PrimitiveScratch scratch;
  const double error = relative_error({backend, "error", scratch}, {p.moments.view(), {}, {1, 0, 3, 2}, 3});
  EXPECT_NEAR(error, std::sqrt(0.25) / 2, 1e-6);
}

TEST(Accumulate, CountsSequenceElementsOfEachPixel) {
  Pixels p(2);
  std::vector<uint32_t> taken{5, 5};
  p.allocation = {1, 0};
  AccumulateKernel kernel = p.kernel();
  kernel.taken = mutable_view_of(taken);
  for (const uint32_t pixel : {0u, 1u}) kernel(pixel, 0);
  EXPECT_EQ(taken, (std::vector<uint32_t>{6, 5}));
}

/// Pixels with a splat image. Pixel 0 gets camera samples, pixel 1 gets none.
struct SplatPixels : Pixels {
  SplatPixels() : Pixels(2), splats(2), light_mean(2), light_m2(2), light_paths(2), light_frames(2) {
    allocation = {1, 0};
  }
  /// Renders a frame: the camera's sample `seen` at pixel 0, splats `brought` at both.
  void frame(float seen, float brought, float paths) {
    splats = {Rgb(brought), Rgb(brought)};
    radiance = {Rgb(seen + brought), Rgb(brought)};
    AccumulateKernel k = kernel();
    k.splat_image = {view_of(splats),
                     mutable_view_of(light_mean),
                     mutable_view_of(light_m2),
                     mutable_view_of(light_paths),
                     mutable_view_of(light_frames),
                     paths};
    k.keep = keep;
    for (const uint32_t pixel : {0u, 1u}) k(pixel, 0);
  }

  bool keep = true;
  std::vector<Rgb> splats;
  std::vector<Rgb> light_mean;
  std::vector<float> light_m2;
  std::vector<float> light_paths;
  std::vector<uint32_t> light_frames;
};

TEST(SplatImage, PixelsWithoutSamplesKeepTheirSplats) {
  SplatPixels p;
  p.frame(3, 8, 0.25f);
  p.frame(5, 4, 0.75f);
  // Light paths: (0.25 · 8 + 0.75 · 4) / 1 = 5; the camera's samples: 4.
  EXPECT_EQ(p.light_mean[0], Rgb(5));
  EXPECT_EQ(p.moments.mean[0], Rgb(9));
  EXPECT_EQ(p.moments.mean[1], Rgb(5));
  EXPECT_EQ(p.moments.samples, (std::vector<uint32_t>{2, 0}));
  EXPECT_FLOAT_EQ(p.moments.m2[0], 2.0f) << "of the camera's samples alone";
}

TEST(SplatImage, AFrameWithoutLightPathsChangesNothing) {
  SplatPixels p;
  p.frame(3, 8, 1);
  p.frame(3, 0, 0);
  EXPECT_EQ(p.light_mean[1], Rgb(8));
  EXPECT_EQ(p.light_frames[1], 1u);
}

TEST(SplatImage, StartsAgainWithTheMean) {
  SplatPixels p;
  p.frame(3, 8, 0.25f);
  p.allocation = {1, 1};
  p.keep = false;  // as in the frame that ends a pilot
  p.frame(5, 4, 0.75f);
  EXPECT_EQ(p.light_mean[0], Rgb(4));
  EXPECT_EQ(p.light_paths[0], 0.75f);
  EXPECT_EQ(p.light_frames[0], 1u);
  EXPECT_EQ(p.moments.mean, (std::vector<Rgb>{Rgb(9), Rgb(4)}));
  EXPECT_EQ(p.moments.samples, (std::vector<uint32_t>{1, 1}));
  EXPECT_EQ(p.moments.m2[0], 0.0f);
  EXPECT_EQ(p.moments.m2_rgb[0], 0.0f);
}

/// Moments of the caustic layer of one pixel, over frames.
struct LayerPixel {
  void frame(float light, bool sampled, bool finite, const PixelSplats& splats = {}) {
    const std::vector<Rgb> radiance{Rgb(light)};
    CausticMoments{view_of(radiance), moments.mutable_view()}.add(0, keep, sampled, finite, splats);
  }

  bool keep = true;
  testing::MomentVectors moments{1};
};

TEST(CausticMoments, AreThoseOfTheSamples) {
  LayerPixel p;
  p.frame(1, true, true);
  p.frame(3, true, true);
  p.frame(9, false, true);  // no sample
  EXPECT_EQ(p.moments.mean[0], Rgb(2));
  EXPECT_FLOAT_EQ(p.moments.m2[0], 2.0f);
  EXPECT_EQ(p.moments.samples[0], 2u);
  p.frame(5, true, false);  // its radiance is not finite
  EXPECT_NEAR(p.moments.mean[0].g, 4.0f / 3, 1e-6f);
  p.keep = false;
  p.frame(7, true, true);
  EXPECT_EQ(p.moments.mean[0], Rgb(7));
  EXPECT_EQ(p.moments.samples[0], 1u);
}

TEST(CausticMoments, ContainTheSplatImage) {
  LayerPixel p;
  p.frame(6, true, true, {Rgb(4), Rgb(0), Rgb(4)});   // splats 4, merged light 2
  p.frame(8, false, true, {Rgb(8), Rgb(4), Rgb(6)});  // splats alone
  EXPECT_EQ(p.moments.mean[0], Rgb(8));
  EXPECT_EQ(p.moments.samples[0], 1u);
  p.frame(10, true, true, {Rgb(6), Rgb(6), Rgb(6)});  // merged light 4
  EXPECT_EQ(p.moments.mean[0], Rgb(9));
  EXPECT_EQ(p.moments.samples[0], 2u);
}

TEST(SplatImage, EstimatesTheVarianceOfItsMean) {
  // Frames of unequal numbers of light paths w, whose splats have the variance 1 / w.
  constexpr int kRuns = 4000;
  constexpr int kFrames = 6;
  testing::Random random(1);
  double estimated = 0;
  double squares = 0;
  for (int run = 0; run < kRuns; ++run) {
    SplatPixels p;
    for (int i = 0; i < kFrames; ++i) {
      const float paths = i % 2 == 0 ? 0.25f : 1.0f;
      const float uniform = random.next() - 0.5f;  // variance 1/12
      p.frame(0, 10 + uniform * std::sqrt(12.0f / paths), paths);
    }
    estimated += splat_variance(p.light_m2[1], p.light_paths[1], p.light_frames[1]);
    squares += (p.moments.mean[1].x - 10) * (p.moments.mean[1].x - 10);
  }
  const double expected = 1 / (3 * 0.25 + 3 * 1.0);
  EXPECT_NEAR(estimated / kRuns, expected, 0.03 * expected);
  EXPECT_NEAR(squares / kRuns, expected, 0.1 * expected);
}

}  // namespace
}  // namespace relume
