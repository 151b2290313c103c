#include "techniques/temporal/reprojection/backward.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "techniques/temporal/reprojection/row_origin.h"
#include "techniques/temporal/reprojection/testing/plane.h"

namespace relume {
namespace {

using testing::History;
using testing::Plane;

TEST(BackwardReprojection, InterpolatesAndLeavesOtherSurfacesOut) {
  Plane plane;
  std::vector<float> values(16);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  const View<const float> old = view_of(values);
  const BackwardReprojection reprojection = plane.reprojection();
  EXPECT_FLOAT_EQ(reprojection.taps(3, 1).fetch(old), 6.5f);  // between pixels 6 and 7
  EXPECT_FLOAT_EQ(reprojection.taps(2, 1).fetch(old), 6.0f);  // pixel 5 is another surface
  EXPECT_FLOAT_EQ(reprojection.taps(0, 1).fetch(old), 4.0f);  // half outside the image
  std::vector<uint32_t> counts(16, 20);
  counts[6] = 9;
  EXPECT_EQ(reprojection.taps(3, 1).least(view_of(counts)), 9u);
  EXPECT_EQ(reprojection.taps(0, 1).least(view_of(counts)), 20u);
  plane.motion[0] = Vec2(9, 0);
  EXPECT_FALSE(reprojection.taps(0, 0).valid);
  EXPECT_EQ(reprojection.taps(0, 0).least(view_of(counts)), 0u);
}

TEST(BackwardReprojection, FindsRowsThatWereSideBySide) {
  constexpr uint32_t kWidth = 24;
  std::vector<Vec2> motion(2 * kWidth, Vec2(-2.25f, 0.5f));
  RowOrigin origin;
  ASSERT_TRUE(find_row(view_of(motion), kWidth, 8, 1, origin));
  EXPECT_EQ(origin.x, 10);
  EXPECT_EQ(origin.y, 0);
  for (uint32_t i = 0; i < kLanes; ++i) {
    EXPECT_EQ(origin.fraction_x[i], 0.25f);
    EXPECT_EQ(origin.fraction_y[i], 0.5f);
  }
  motion[kWidth + 11] = Vec2(-2.5f, 0.6f);  // between the same pixels
  EXPECT_TRUE(find_row(view_of(motion), kWidth, 8, 1, origin));
  for (const Vec2& apart : {Vec2(-3.25f, 0.5f), Vec2(-2.25f, 1.5f), Vec2(65504), Vec2(NAN, 0.5f), Vec2(-2.25f, NAN)}) {
    motion[kWidth + 11] = apart;
    EXPECT_FALSE(find_row(view_of(motion), kWidth, 8, 1, origin));
    EXPECT_TRUE(find_row(view_of(motion), kWidth, 12, 1, origin));
  }
  motion.assign(2 * kWidth, Vec2(1e30f, 0));
  EXPECT_FALSE(find_row(view_of(motion), kWidth, 8, 1, origin));
}

TEST(BackwardReprojection, ExcludesTapsWithoutSamples) {
  Plane plane;
  std::vector<float> values(16);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  std::vector<uint32_t> counts(16, 20);
  const BackwardTaps all = plane.reprojection().taps(3, 1);
  const BackwardTaps same = all.known(view_of(counts));
  EXPECT_FLOAT_EQ(same.fetch(view_of(values)), 6.5f);
  counts[6] = 0;
  const BackwardTaps known = all.known(view_of(counts));
  EXPECT_TRUE(known.valid);
  EXPECT_FLOAT_EQ(known.fetch(view_of(values)), 7.0f);
  EXPECT_EQ(known.least(view_of(counts)), 20u);
  counts[7] = 0;
  EXPECT_FALSE(all.known(view_of(counts)).valid);
}

struct NewHistory {
  testing::MomentVectors moments{16};
  std::vector<uint32_t> sources = std::vector<uint32_t>(16);
  std::vector<uint32_t> kept = std::vector<uint32_t>(16);
  std::vector<uint32_t> reasons = std::vector<uint32_t>(16);
};

BackwardHistoryKernel kernel_of(const Plane& plane, const History& before, NewHistory& now) {
  return {.reprojection = plane.reprojection(),
          .history = {.before = before.view(), .now = now.moments.mutable_view()},
          .sources = mutable_view_of(now.sources),
          .kept = mutable_view_of(now.kept),
          .reasons = mutable_view_of(now.reasons)};
}

TEST(BackwardReprojection, InterpolatesVariances) {
  const Plane plane;
  History before;
  NewHistory now;
  before.samples[6] = 3;
  before.m2[6] = 2 * 1.0f;  // (n − 1) times the variance
  before.m2[7] = 8 * 5.0f;
  before.m2_rgb[6] = 2 * 6.0f;
  before.m2_rgb[7] = 8 * 12.0f;
  kernel_of(plane, before, now)(3, 1);  // between pixels 6 and 7
  EXPECT_EQ(now.moments.samples[7], 3u);
  EXPECT_FLOAT_EQ(now.moments.m2[7], 2 * 3.0f);
  EXPECT_FLOAT_EQ(now.moments.m2_rgb[7], 2 * 9.0f);
  before.samples[6] = 1;  // one sample has no variance
  kernel_of(plane, before, now)(3, 1);
  EXPECT_EQ(now.moments.samples[7], 1u);
  EXPECT_EQ(now.moments.m2[7], 0.0f);
}

TEST(BackwardReprojection, PixelsWithoutAHistoryHaveAReason) {
  Plane plane;
  plane.motion[0] = Vec2(9, 0);
  plane.motion[1] = Vec2(-1, -1);  // was at pixel 6, which has no samples
  plane.motion[2] = Vec2(1, -1);   // was at pixel 5, another surface
  History before;
  NewHistory now;
  before.samples[6] = 0;
  for (uint32_t x = 0; x < 4; ++x) kernel_of(plane, before, now)(x, 0);
  const RejectReason expected[] = {RejectReason::off_screen, RejectReason::empty, RejectReason::other_surface,
                                   RejectReason::none};
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(static_cast<RejectReason>(now.reasons[i]), expected[i]) << i;
    EXPECT_EQ(now.kept[i], i == 3 ? 1u : 0u) << i;
    EXPECT_EQ(now.moments.m2_rgb[i], i == 3 ? 6.0f : 0.0f) << i;
    EXPECT_EQ(now.sources[i], i == 3 ? 2u : kNoSource) << i;
  }
}

}  // namespace
}  // namespace relume
