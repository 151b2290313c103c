#include "techniques/temporal/reprojection/specular_history.h"

#include <gtest/gtest.h>

#include <vector>

#include "framebuffer/testing/moment_vectors.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 8;

/// One row of a floor at rest, whose reflections move by two pixels.
struct Row {
  std::vector<Vec2> motion = std::vector<Vec2>(kWidth, Vec2(2, 0));
  std::vector<Vec3> position = std::vector<Vec3>(kWidth, Vec3(0));
  std::vector<Vec3> normal = std::vector<Vec3>(kWidth, Vec3(0, 1, 0));
  std::vector<float> depth = std::vector<float>(kWidth, 1.0f);
  std::vector<uint32_t> surface = std::vector<uint32_t>(kWidth, 3);
  std::vector<Rgb> before = std::vector<Rgb>(kWidth, Rgb(0));
  std::vector<uint32_t> samples_before = std::vector<uint32_t>(kWidth, 9);
  std::vector<Rgb> now = std::vector<Rgb>(kWidth, Rgb(0));
  std::vector<uint32_t> samples = std::vector<uint32_t>(kWidth, 0);

  BackwardReprojection reprojection(const std::vector<Vec2>& by) const {
    return {view_of(by),       view_of(position), view_of(normal),  view_of(depth), view_of(surface),
            view_of(position), view_of(normal),   view_of(surface), kWidth,         1};
  }
  void move(uint32_t max_samples) {
    SpecularHistoryKernel kernel;
    kernel.reflections = reprojection(motion);
    kernel.before = view_of(before);
    kernel.samples_before = view_of(samples_before);
    kernel.now = mutable_view_of(now);
    kernel.samples = mutable_view_of(samples);
    kernel.max_samples = max_samples;
    for (uint32_t x = 0; x < kWidth; ++x) kernel(x, 0);
  }
};

TEST(SpecularHistory, MovesWithTheReflection) {
  Row row;
  testing::MomentVectors moments(kWidth, {Rgb(0), 0, 0, 9});
  for (uint32_t x = 0; x < kWidth; ++x) {
    row.before[x] = Rgb(x < 4 ? 2.0f : 0.0f);
    moments.mean[x] = Rgb(x < 6 ? 1.0f : 5.0f) + row.before[x];
  }
  row.move(4);
  EXPECT_EQ(row.samples[1], 0u) << "the image came from beyond the border";
  testing::MomentVectors inherited(kWidth);
  const InterpolatedHistory history{.before = moments.view(),
                                    .now = inherited.mutable_view(),
                                    .specular_before = view_of(row.before),
                                    .specular = view_of(row.now)};
  const std::vector<Vec2> still(kWidth, Vec2(0));
  for (uint32_t x = 0; x < kWidth; ++x) history.inherit(x, row.reprojection(still).taps(x, 0));
  for (uint32_t x = 2; x < kWidth; ++x) {
    EXPECT_EQ(row.samples[x], 4u) << "limited";
    EXPECT_EQ(inherited.mean[x], Rgb(x < 6 ? 1.0f : 5.0f) + Rgb(x < 6 ? 2.0f : 0.0f)) << x;
  }
}

}  // namespace
}  // namespace relume
