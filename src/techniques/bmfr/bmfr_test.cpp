#include "techniques/bmfr/bmfr.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "techniques/bmfr/regression_kernel.h"

namespace relume {
namespace {

/// Least squares by normal equations and Gaussian elimination with pivoting, in double precision.
std::vector<double> solve_dense(const std::vector<std::vector<double>>& rows, const std::vector<double>& values) {
  const size_t n = rows[0].size();
  std::vector<std::vector<double>> a(n, std::vector<double>(n + 1, 0.0));
  for (size_t r = 0; r < rows.size(); ++r) {
    for (size_t i = 0; i < n; ++i) {
      for (size_t j = 0; j < n; ++j) a[i][j] += rows[r][i] * rows[r][j];
      a[i][n] += rows[r][i] * values[r];
    }
  }
  for (size_t k = 0; k < n; ++k) {
    size_t pivot = k;
    for (size_t i = k; i < n; ++i) pivot = std::fabs(a[i][k]) > std::fabs(a[pivot][k]) ? i : pivot;
    std::swap(a[k], a[pivot]);
    for (size_t i = 0; i < n; ++i) {
      const double factor = i == k ? 0.0 : a[i][k] / a[k][k];
      for (size_t j = k; j <= n && factor != 0.0; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  std::vector<double> x(n);
  for (size_t k = 0; k < n; ++k) x[k] = a[k][n] / a[k][k];
  return x;
}

/// A block of random rows, and its fit.
struct Block {
  explicit Block(uint32_t seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> uniform(-1, 1);
    for (auto& column : columns) {
      column.resize(kBlockPixels);
      for (float& value : column) value = uniform(generator);
    }
    for (float& value : columns[0]) value = 1;
  }

  BlockFit fit() const {
    BlockRegression regression;
    regression.begin();
    for (uint32_t first = 0; first < kBlockPixels; first += BlockRegression::kPanelRows) {
      for (int c = 0; c < kBlockColumns; ++c) {
        for (uint32_t i = 0; i < BlockRegression::kPanelRows; ++i)
          regression.columns[c][BlockRegression::kTriangle + i] = columns[static_cast<size_t>(c)][first + i];
      }
      regression.add_panel();
    }
    return regression.fit();
  }

  std::vector<std::vector<float>> columns = std::vector<std::vector<float>>(kBlockColumns);
};

TEST(BlockRegression, AgreesWithADenseSolver) {
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    const Block block(seed);
    std::vector<std::vector<double>> rows(kBlockPixels, std::vector<double>(kBlockFeatures));
    for (uint32_t i = 0; i < kBlockPixels; ++i) {
      for (size_t f = 0; f < kBlockFeatures; ++f) rows[i][f] = static_cast<double>(block.columns[f][i]);
    }
    const BlockFit fit = block.fit();
    for (int channel = 0; channel < 3; ++channel) {
      const auto& light = block.columns[static_cast<size_t>(kBlockFeatures + channel)];
      const std::vector<double> expected = solve_dense(rows, {light.begin(), light.end()});
      for (size_t f = 0; f < kBlockFeatures; ++f)
        EXPECT_NEAR(static_cast<double>(fit.coefficients[channel][f]), expected[f], 1e-5) << seed << " " << f;
    }
  }
}

TEST(BlockRegression, LeavesOutFeaturesThatDependOnOthers) {
  Block block(5);
  block.columns[2] = block.columns[1];                                // a copy
  std::fill(block.columns[3].begin(), block.columns[3].end(), 0.5f);  // a multiple of the constant
  std::fill(block.columns[4].begin(), block.columns[4].end(), 0.0f);
  block.columns[10] = block.columns[1];
  const BlockFit fit = block.fit();
  EXPECT_EQ(fit.coefficients[0][2], 0.0f);
  EXPECT_EQ(fit.coefficients[0][3], 0.0f);
  EXPECT_EQ(fit.coefficients[0][4], 0.0f);
  EXPECT_NEAR(fit.coefficients[0][1], 1.0f, 1e-5f);
  EXPECT_NEAR(fit.coefficients[0][0], 0.0f, 1e-5f);
}

constexpr uint32_t kWidth = 77;  // no multiple of a block
constexpr uint32_t kHeight = 45;
constexpr uint32_t kPixels = kWidth * kHeight;

/// A bumpy surface, and light on it.
struct Surface {
  Surface() {
    for (uint32_t i = 0; i < kPixels; ++i) {
      const float x = static_cast<float>(i % kWidth) / 10.0f;
      const float y = static_cast<float>(i / kWidth) / 10.0f;
      position[i] = Vec3(x, y, 5.0f + std::sin(x) * std::cos(1.3f * y));
      normal[i] = glm::normalize(Vec3(std::sin(3.0f * x), std::cos(2.0f * y), 1.5f));
    }
  }

  void fit(uint32_t shift_x, uint32_t shift_y, float noise_scale) {
    const BlockNoiseKernel fill{mutable_view_of(noise), 3};
    for (uint32_t y = 0; y < kBlockFeatures - 1; ++y) {
      for (uint32_t x = 0; x < kBlockPixels; ++x) fill(x, y);
    }
    BlockRegressionKernel kernel;
    kernel.position = view_of(position);
    kernel.normal = view_of(normal);
    kernel.albedo = view_of(albedo);
    kernel.light = view_of(light);
    kernel.samples = view_of(samples);
    kernel.square = view_of(square);
    kernel.noise = view_of(noise);
    kernel.fitted = mutable_view_of(fitted);
    kernel.noise_scale = noise_scale;
    kernel.detail = detail;
    kernel.share = share;
    kernel.shift_x = shift_x;
    kernel.shift_y = shift_y;
    kernel.width = kWidth;
    kernel.height = kHeight;
    std::fill(fitted.begin(), fitted.end(), Rgb(4));
    for (uint32_t y = 0; y < BlockRegressionKernel::blocks(kHeight); ++y) {
      for (uint32_t x = 0; x < BlockRegressionKernel::blocks(kWidth); ++x) kernel(x, y);
    }
  }

  std::vector<Vec3> position = std::vector<Vec3>(kPixels);
  std::vector<Vec3> normal = std::vector<Vec3>(kPixels);
  std::vector<Rgb> albedo = std::vector<Rgb>(kPixels, Rgb(0.5f));
  std::vector<Rgb> light = std::vector<Rgb>(kPixels, Rgb(2, 1, 0.5f));
  std::vector<uint32_t> samples = std::vector<uint32_t>(kPixels, 1);
  std::vector<float> square = std::vector<float>(kPixels);
  std::vector<Rgb> fitted = std::vector<Rgb>(kPixels);
  std::vector<float> noise = std::vector<float>(kBlockNoise);
  float detail = 0;
  float share = 1;
};

TEST(Bmfr, KeepsLightThatFeaturesExplain) {
  Surface s;
  for (uint32_t i = 0; i < kPixels; ++i) {
    const Vec3 p = s.position[i];
    s.light[i] = Rgb(3) + 0.5f * s.normal[i] + Rgb(0.2f, -0.1f, 0.3f) * p + Rgb(0.02f, 0.01f, 0.03f) * p * p;
  }
  for (const UVec2 shift : {UVec2(0, 0), UVec2(13, 31), UVec2(31, 1)}) {
    s.fit(shift.x, shift.y, 0.0f);
    for (uint32_t i = 0; i < kPixels; ++i)
      ASSERT_LT(max_component(abs(s.fitted[i] - s.light[i])), 1e-3f) << i;  // of about 4: float's rounding
  }
}

TEST(Bmfr, KeepsAConstantDespiteTheNoiseOfFeatures) {
  Surface s;
  for (const UVec2 shift : {UVec2(0, 0), UVec2(7, 20)}) {
    s.fit(shift.x, shift.y, 0.01f);
    for (uint32_t i = 0; i < kPixels; ++i) ASSERT_LT(max_component(abs(s.fitted[i] - s.light[i])), 1e-4f) << i;
  }
}

TEST(Bmfr, FitsCanBeAveraged) {
  Surface s;
  s.share = 0.25f;
  s.fit(7, 20, 0.0f);  // light of (2, 1, 0.5) on top of 4
  for (uint32_t i = 0; i < kPixels; ++i) ASSERT_NEAR(s.fitted[i].g, 3.25f, 1e-4f) << i;
}

TEST(Bmfr, KeepsTheEnergyOfEachBlock) {
  Surface s;
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> uniform(0.5f, 1.5f);
  for (Rgb& light : s.light) light = Rgb(uniform(generator));
  s.fit(0, 0, 0.0f);
  double before = 0;
  double after = 0;
  for (uint32_t y = 0; y < kBlockSize; ++y) {  // the first block, whose window is what it writes
    for (uint32_t x = 0; x < kBlockSize; ++x) {
      before += static_cast<double>(s.light[y * kWidth + x].g);
      after += static_cast<double>(s.fitted[y * kWidth + x].g);
    }
  }
  EXPECT_NEAR(after / before, 1.0, 1e-5);
}

TEST(Bmfr, RemovesNoiseThatFeaturesDoNotExplain) {
  Surface s;
  std::mt19937 generator(2);
  std::exponential_distribution<float> exponential(1.0f);
  for (Rgb& light : s.light) light = Rgb(exponential(generator));
  s.fit(5, 9, 0.01f);
  double squared = 0;
  for (const Rgb& value : s.fitted) squared += static_cast<double>(sqr(value.g - 1.0f));
  // Ten coefficients from 1024 pixels of variance 1 leave 10 / 1024 of it; border blocks share pixels.
  EXPECT_LT(squared / kPixels, 0.02);
}

TEST(Bmfr, PixelsWithoutSamplesTakeNoPartButAreFitted) {
  Surface s;
  for (uint32_t i = 0; i < kPixels; i += 3) {
    s.samples[i] = 0;
    s.light[i] = Rgb(1000);
  }
  for (uint32_t i = 1; i < kPixels; i += 3) s.albedo[i] = Rgb(0);
  for (uint32_t i = 1; i < kPixels; i += 3) s.light[i] = Rgb(1000);
  s.fit(3, 4, 0.01f);
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (i % 3 == 1) continue;
    ASSERT_LT(max_component(abs(s.fitted[i] - Rgb(2, 1, 0.5f))), 1e-3f) << i;
  }
}

/// A still or moving picture of light on one plane.
struct History {
  History() {
    for (uint32_t i = 0; i < kPixels; ++i)
      position[i] = Vec3(static_cast<float>(i % kWidth), static_cast<float>(i / kWidth), 0);
  }

  void accumulate(uint32_t max_samples) {
    light.swap(light_before);
    count.swap(count_before);
    square.swap(square_before);
    BmfrAccumulateKernel kernel;
    kernel.history.reprojection = {
        view_of(motion),   view_of(came_from), view_of(normal),         view_of(depth), view_of(surface),
        view_of(position), view_of(normal),    view_of(surface_before), kWidth,         kHeight};
    for (uint32_t i = 0; i < kPixels; ++i) scattered[i] = radiance[i] - emission[i];
    kernel.history.samples = samples();
    kernel.history.light_before = view_of(light_before);
    kernel.history.count_before = view_of(count_before);
    kernel.fitted_before = view_of(light_before);
    kernel.square_before = view_of(square_before);
    kernel.history.light = mutable_view_of(light);
    kernel.history.count = mutable_view_of(count);
    kernel.fitted_history = mutable_view_of(fitted_history);
    kernel.square = mutable_view_of(square);
    kernel.age = mutable_view_of(age);
    kernel.history.max_samples = max_samples;
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x) kernel(x, y);
    }
  }

  SurfaceLight samples() const {
    return {view_of(radiance), view_of(scattered), view_of(allocation), view_of(albedo), view_of(emission)};
  }

  std::vector<Vec3> position = std::vector<Vec3>(kPixels);
  std::vector<Vec3> came_from = std::vector<Vec3>(kPixels);
  std::vector<Vec3> normal = std::vector<Vec3>(kPixels, Vec3(0, 0, 1));
  std::vector<Vec2> motion = std::vector<Vec2>(kPixels, Vec2(0));
  std::vector<float> depth = std::vector<float>(kPixels, 10.0f);
  std::vector<uint32_t> surface = std::vector<uint32_t>(kPixels, 0);
  std::vector<uint32_t> surface_before = surface;
  std::vector<Rgb> albedo = std::vector<Rgb>(kPixels, Rgb(0.5f));
  std::vector<Rgb> emission = std::vector<Rgb>(kPixels, Rgb(0));
  std::vector<Rgb> radiance = std::vector<Rgb>(kPixels, Rgb(1));
  std::vector<Rgb> scattered = radiance;
  std::vector<uint32_t> allocation = std::vector<uint32_t>(kPixels, 1);
  std::vector<Rgb> light = std::vector<Rgb>(kPixels, Rgb(0));
  std::vector<Rgb> light_before = light;
  std::vector<Rgb> fitted_history = light;
  std::vector<float> square = std::vector<float>(kPixels, 0.0f);
  std::vector<float> square_before = square;
  std::vector<uint32_t> count = std::vector<uint32_t>(kPixels, 0);
  std::vector<uint32_t> count_before = count;
  std::vector<uint32_t> age = count;
};

TEST(Bmfr, StillPixelsKeepTheMeanOfTheirSamples) {
  History h;
  for (int frame = 1; frame <= 5; ++frame) {
    h.radiance.assign(kPixels, Rgb(static_cast<float>(frame)));
    h.accumulate(kNoHistoryLimit);
  }
  EXPECT_EQ(h.count[17], 5u);
  EXPECT_NEAR(h.light[17].r, 3.0f / 0.5f, 1e-5f);  // mean over albedo
  EXPECT_NEAR(h.square[17], 11.0f / 0.25f, 1e-3f);
  EXPECT_EQ(h.age[17], 4u);
  h.accumulate(3);  // the history now counts for three
  EXPECT_EQ(h.count[17], 4u);
  EXPECT_NEAR(h.light[17].r, (3.0f * 6.0f + 10.0f) / 4.0f, 1e-5f);
}

TEST(Bmfr, LightFollowsItsSurface) {
  History h;
  for (uint32_t i = 0; i < kPixels; ++i) h.radiance[i] = Rgb(static_cast<float>(i % kWidth));
  h.accumulate(kNoHistoryLimit);
  // The picture moves three pixels to the right: what was at x − 3 is at x.
  h.motion.assign(kPixels, Vec2(3, 0));
  for (uint32_t i = 0; i < kPixels; ++i) h.came_from[i] = h.position[i] - Vec3(3, 0, 0);
  for (Rgb& radiance : h.radiance) radiance = Rgb(0);
  h.accumulate(kNoHistoryLimit);
  const uint32_t row = 20 * kWidth;
  for (uint32_t x = 3; x < kWidth; ++x) {
    EXPECT_EQ(h.count[row + x], 2u);
    EXPECT_NEAR(h.light[row + x].r, static_cast<float>(x - 3), 1e-4f);  // half of (x − 3) / albedo
  }
  EXPECT_EQ(h.count[row + 1], 1u);  // came in at the border
}

TEST(Bmfr, BlackTexelsTakeNothingFromTheHistoryBesideThem) {
  History h;
  const uint32_t black = 20 * kWidth + 20;
  h.albedo[black] = Rgb(0);
  h.accumulate(kNoHistoryLimit);
  h.motion.assign(kPixels, Vec2(0.5f, 0));  // each pixel was between two
  for (uint32_t i = 0; i < kPixels; ++i) h.came_from[i] = h.position[i] - Vec3(0.5f, 0, 0);
  h.accumulate(kNoHistoryLimit);
  EXPECT_EQ(h.count[black - 1], 2u);
  EXPECT_EQ(h.count[black + 1], 2u);
  EXPECT_NEAR(h.light[black + 1].r, 2.0f, 1e-5f);
}

TEST(Bmfr, OtherSurfacesHaveNoHistory) {
  History h;
  h.accumulate(kNoHistoryLimit);
  h.surface.assign(kPixels, 7);
  h.accumulate(kNoHistoryLimit);
  EXPECT_EQ(h.count[100], 1u);
}

TEST(Bmfr, SamplesThatAreNotFiniteOrNotThereLeaveTheHistoryAlone) {
  History h;
  h.accumulate(kNoHistoryLimit);
  const Rgb known = h.light[0];
  h.radiance[0] = Rgb(std::numeric_limits<float>::quiet_NaN());
  h.radiance[1] = Rgb(0, kInfinity, 0);
  h.allocation[2] = 0;
  h.radiance[2] = Rgb(0);
  h.accumulate(kNoHistoryLimit);
  for (uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(h.count[i], 1u);
    EXPECT_EQ(h.light[i], known);
  }
  EXPECT_EQ(h.count[3], 2u);
}

TEST(Bmfr, EmissionAndBlackSurfacesAreNotFiltered) {
  History h;
  h.emission.assign(kPixels, Rgb(0.75f));
  h.accumulate(kNoHistoryLimit);
  EXPECT_NEAR(h.light[5].g, 0.5f, 1e-6f);  // (1 − 0.75) / 0.5
  const SurfaceLight samples = h.samples();
  EXPECT_NEAR(samples.picture(5, h.light[5]).g, 1.0f, 1e-6f);
  EXPECT_EQ(samples.picture(5, Rgb(-2)), Rgb(0));  // samples missed the lamp: no darker than black
  h.albedo[5] = Rgb(0);
  EXPECT_FALSE(samples.at(5).valid);
  EXPECT_EQ(samples.picture(5, Rgb(100)), Rgb(1));  // the sample itself
  h.allocation[5] = 0;
  EXPECT_EQ(samples.picture(5, Rgb(100)), Rgb(0.75f));
}

}  // namespace
}  // namespace relume
