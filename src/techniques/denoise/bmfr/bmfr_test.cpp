// Block regression and its kernel.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "techniques/denoise/bmfr/regression_kernel.h"

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
      const auto& light = block.columns[static_cast<size_t>(int64_t{kBlockFeatures} + channel)];
      const std::vector<double> expected = solve_dense(rows, {light.begin(), light.end()});
      for (size_t f = 0; f < kBlockFeatures; ++f)
        EXPECT_NEAR(static_cast<double>(fit.coefficients[channel][f]), expected[f], 1e-5) << seed << " " << f;
    }
  }
}

TEST(BlockRegression, OmitsLinearlyDependentFeatures) {
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

constexpr uint32_t kWidth = 77;  // not a multiple of a block
constexpr uint32_t kHeight = 45;
constexpr uint32_t kPixels = kWidth * kHeight;

/// A bumpy surface and the light on it.
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
    kernel.most_samples = most_samples;
    kernel.share = share;
    kernel.shift_x = shift_x;
    kernel.shift_y = shift_y;
    kernel.width = kWidth;
    kernel.height = kHeight;
    std::fill(fitted.begin(), fitted.end(), Rgb(4));
    for (uint32_t y = 0; y < BlockRegressionKernel::blocks(kHeight); ++y) {
      for (uint32_t x = 0; x < BlockRegressionKernel::blocks(kWidth); ++x) run_group(kernel, x, y, KernelForm::host);
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
  float most_samples = kInfinity;
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
      ASSERT_LT(max_component(abs(s.fitted[i] - s.light[i])), 1e-3f) << i;  // rounding of floats of about 4
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
  s.fit(7, 20, 0.0f);  // light of (2, 1, 0.5) averaged with 4
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
  for (uint32_t y = 0; y < kBlockSize; ++y) {  // the first block writes its whole window
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
  // Ten coefficients from 1024 pixels of variance 1 keep 10 / 1024 of it; border blocks share pixels.
  EXPECT_LT(squared / kPixels, 0.02);
}

TEST(Bmfr, PixelsWithoutSamplesAreFittedButNotUsed) {
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

TEST(BlockRegression, LimitsTheSampleCountOfFadingLight) {
  // Noise around one value. Each pixel claims a hundred samples.
  const auto spread = [](float most_samples) {
    Surface s;
    std::mt19937 generator(4);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (uint32_t i = 0; i < kPixels; ++i) {
      s.samples[i] = 100;
      s.light[i] = Rgb(1.0f + uniform(generator));
      s.square[i] = sqr(s.light[i].g) + (9.0f - 1.0f) / 12.0f;  // as for nine samples whose mean has that variance
    }
    s.detail = 1.5f;
    s.most_samples = most_samples;
    s.fit(5, 9, 0.01f);
    double squared = 0;
    for (const Rgb& value : s.fitted) squared += static_cast<double>(sqr(value.g - 1.5f)) / kPixels;
    return squared;
  };
  EXPECT_GT(spread(kInfinity), 0.04);  // kept as details: half of the noise's 1/12
  EXPECT_LT(spread(9), 0.01);
}

}  // namespace
}  // namespace relume
