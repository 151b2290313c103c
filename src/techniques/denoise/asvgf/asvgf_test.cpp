#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "techniques/denoise/asvgf/adaptive_alpha.h"
#include "techniques/denoise/asvgf/settings.h"
#include "techniques/denoise/shared/light_history.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 80;  // not a multiple of strata
constexpr uint32_t kHeight = 50;
constexpr uint32_t kPixels = kWidth * kHeight;
constexpr uint32_t kColumns = strata(kWidth);
constexpr uint32_t kRows = strata(kHeight);

/// Gradients on a wall that faces the camera. A pixel is a millimetre wide.
struct Wall {
  Wall() {
    for (uint32_t i = 0; i < kPixels; ++i)
      position[i] = 0.001f * Vec3(static_cast<float>(i % kWidth), static_cast<float>(i / kWidth), 0);
  }

  void filter(int levels) {
    PrepareGradientsKernel prepare;
    prepare.gradients = view_of(gradients);
    prepare.position = view_of(position);
    prepare.normal = view_of(normal);
    prepare.depth = view_of(depth);
    prepare.surface = view_of(surface);
    prepare.features = image(features);
    prepare.planes = image(planes);
    prepare.cone_spread = 0.001f;
    prepare.width = kWidth;
    prepare.height = kHeight;
    for (uint32_t y = 0; y < kRows; ++y) {
      for (uint32_t x = 0; x < kColumns; ++x) prepare(x, y);
    }
    for (int level = 0; level < levels; ++level) {
      AtrousKernel kernel;
      kernel.features = image(features);
      kernel.light = image(planes);
      kernel.filtered = image(filtered);
      kernel.step = 1u << level;
      kernel.light_tolerance = kAnyLight;
      for (uint32_t y = 0; y < kRows; ++y) {
        for (uint32_t x = 0; x < kColumns; ++x) kernel(x, y);
      }
      planes.swap(filtered);
    }
  }

  std::vector<float> lambdas(float antilag = 1) {
    std::vector<float> result(kPixels, -1.0f);
    const LambdaKernel kernel{image(planes), mutable_view_of(result), antilag, kWidth, kHeight};
    for (uint32_t y = 0; y < kRows; ++y) {
      for (uint32_t x = 0; x < kColumns; ++x) kernel(x, y);
    }
    return result;
  }

  static AtrousImage image(std::vector<float>& values) { return {mutable_view_of(values), kColumns, kRows}; }

  std::vector<Vec2> gradients = std::vector<Vec2>(size_t{kColumns} * kRows, Vec2(0, 1));
  std::vector<Vec3> position = std::vector<Vec3>(kPixels);
  std::vector<Vec3> normal = std::vector<Vec3>(kPixels, Vec3(0, 0, 1));
  std::vector<float> depth = std::vector<float>(kPixels, 1.0f);
  std::vector<uint32_t> surface = std::vector<uint32_t>(kPixels, 1);
  std::vector<float> features = std::vector<float>(AtrousImage::size(kAtrousPlanes, kColumns, kRows));
  std::vector<float> planes = std::vector<float>(AtrousImage::size(kAtrousChannels, kColumns, kRows));
  std::vector<float> filtered = planes;
};

TEST(Asvgf, AdaptedAgesGiveTheWeightOfThePaper) {
  for (const uint32_t age : {0u, 1u, 4u, 9u, 31u, kNoHistoryLimit}) {
    EXPECT_EQ(adapted_age(age, 0.0f), age);
    EXPECT_EQ(adapted_age(age, std::numeric_limits<float>::quiet_NaN()), age);
    EXPECT_EQ(adapted_age(age, 1.0f), 0u);
    for (const float lambda : {0.01f, 0.1f, 0.5f, 0.9f}) {
      const double alpha = 1.0 / (static_cast<double>(age) + 1.0);
      const double weight = (1.0 - static_cast<double>(lambda)) * alpha + static_cast<double>(lambda);
      EXPECT_NEAR(adapted_age(age, lambda), 1.0 / weight - 1.0, 0.5 + 1e-4) << age << " " << lambda;
    }
  }
}

TEST(Asvgf, ChangesShortenTheHistoriesOfFiveByFiveStrata) {
  Wall wall;
  wall.gradients[5 * kColumns + 7] = Vec2(-0.25f, 1);
  wall.filter(0);
  for (const float antilag : {0.0f, 1.0f, 2.0f, 100.0f}) {
    const std::vector<float> lambdas = wall.lambdas(antilag);
    for (uint32_t i = 0; i < kPixels; ++i) {
      const uint32_t x = i % kWidth / kStratum;
      const uint32_t y = i / kWidth / kStratum;
      const bool near = x >= 5 && x <= 9 && y >= 3 && y <= 7;
      ASSERT_EQ(lambdas[i], near ? std::min(1.0f, 0.25f * antilag) : 0.0f) << i << " " << antilag;
    }
  }
}

TEST(Asvgf, BlackAndUnboundedGradientsChangeNothing) {
  Wall wall;
  for (size_t i = 0; i < wall.gradients.size(); ++i) {
    wall.gradients[i] = Vec2(0);
    if (i % 7 == 0) wall.gradients[i] = Vec2(std::numeric_limits<float>::infinity());
  }
  wall.filter(0);
  for (const float lambda : wall.lambdas()) ASSERT_EQ(lambda, 0.0f);
}

TEST(Asvgf, FilterAveragesNoiseOfBothSigns) {
  Wall wall;
  for (uint32_t i = 0; i < kColumns * kRows; ++i) {
    const bool up = (i % kColumns + i / kColumns) % 2 == 0;
    wall.gradients[i] = Vec2(up ? 0.5f : -0.5f, 1);
  }
  wall.filter(0);
  for (const float lambda : wall.lambdas()) ASSERT_EQ(lambda, 0.5f);
  wall.filter(5);
  for (const float lambda : wall.lambdas()) ASSERT_LT(lambda, 0.1f);
}

TEST(Asvgf, SilhouettesAgainstTheBackgroundAreFiltered) {
  Wall wall;
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (i % kWidth > 40) continue;  // the wall begins in the last column of a stratum
    wall.surface[i] = kNoSurface;
    wall.normal[i] = Vec3(0);
  }
  for (uint32_t i = 0; i < kColumns * kRows; ++i) {
    const bool up = (i % kColumns + i / kColumns) % 2 == 0;
    wall.gradients[i] = Vec2(up ? 0.5f : -0.5f, 1);
  }
  wall.filter(5);
  const std::vector<float> lambdas = wall.lambdas();
  for (const float lambda : lambdas) ASSERT_LT(lambda, 0.1f);
  EXPECT_EQ(lambdas[0], 0.0f);
}

TEST(Asvgf, StrataWithoutGradientsTakeThoseAround) {
  Wall wall;
  for (uint32_t i = 0; i < kColumns * kRows; ++i) wall.gradients[i] = i % 4 == 1 ? Vec2(-0.3f, 1) : Vec2(0);
  wall.filter(5);
  for (const float lambda : wall.lambdas()) ASSERT_NEAR(lambda, 0.3f, 1e-4f);
}

TEST(Asvgf, ChangesStopAtEdgesOfSurfaces) {
  for (const bool turn : {true, false}) {
    Wall wall;
    for (uint32_t i = 0; i < kPixels; ++i) {
      if (i % kWidth < 40) continue;
      if (turn) wall.normal[i] = Vec3(1, 0, 0);
      if (!turn) wall.position[i].z += 1.0f;
    }
    for (uint32_t i = 0; i < kColumns * kRows; ++i) {
      if (i % kColumns * kStratum + 1 >= 40) wall.gradients[i] = Vec2(-1, 1);
    }
    wall.filter(5);
    const std::vector<float> lambdas = wall.lambdas();
    EXPECT_LT(lambdas[20 * kWidth + 30], 0.01f);  // beyond the largest of 5 × 5 strata
    EXPECT_GT(lambdas[20 * kWidth + 50], 0.99f);
  }
}

TEST(Asvgf, AlphaLimitsTheHistory) {
  AsvgfSettings settings;
  EXPECT_EQ(svgf_settings(settings, true).history.max_history, 9);  // the tenth sample weighs 0.1
  EXPECT_EQ(svgf_settings(settings, true).history.max_history_changed, 9);
  EXPECT_EQ(svgf_settings(settings, false).history.max_history_changed, DenoiserHistorySettings{}.max_history_changed);
  settings.alpha = 0.5f;
  EXPECT_EQ(svgf_settings(settings, false).history.max_history_changed, 1);
  settings.alpha = 1;
  EXPECT_EQ(svgf_settings(settings, true).history.max_history, 0);
}

}  // namespace
}  // namespace relume
