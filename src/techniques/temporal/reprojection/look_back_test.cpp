#include "techniques/temporal/reprojection/look_back.h"

#include <gtest/gtest.h>

#include <vector>

#include "techniques/temporal/reprojection/cells_history.h"
#include "techniques/temporal/reprojection/reprojection.h"
#include "techniques/temporal/reprojection/testing/plane.h"

namespace relume {
namespace {

using enum RejectReason;

constexpr uint32_t number(RejectReason reject_reason) { return static_cast<uint32_t>(reject_reason); }

/// A plane that moves to the right by half a pixel: (3, 1) was between pixels 6 and 7 of the previous frame.
struct MovedPlane {
  LookBack look_back() const { return {plane.reprojection(), view_of(reject_reasons), view_of(limits)}; }
  BackwardTaps taps() const { return look_back().taps(3, 1); }

  testing::Plane plane;
  std::vector<uint32_t> reject_reasons = std::vector<uint32_t>(16, number(none));
  std::vector<uint32_t> limits = std::vector<uint32_t>(16, 100);
};

TEST(LookBack, TakesNeighboursThatPassedValidation) {
  MovedPlane p;
  EXPECT_FLOAT_EQ(p.taps().weights[0], 0.5f);
  EXPECT_FLOAT_EQ(p.taps().weights[1], 0.5f);
  p.reject_reasons[6] = number(mixed);
  EXPECT_FLOAT_EQ(p.taps().weights[0], 0.5f) << "it saw this surface, too";
  for (const RejectReason reject_reason : {empty, off_screen, occluded, view_dependent, near_specular, relit}) {
    p.reject_reasons[6] = number(reject_reason);
    EXPECT_TRUE(p.taps().valid);
    EXPECT_EQ(p.taps().heaviest(), 7u);
  }
  p.reject_reasons[7] = number(relit);
  EXPECT_FALSE(p.taps().valid);
}

TEST(LookBack, IgnoresHistoriesWithoutWeight) {
  MovedPlane p;
  p.limits[7] = 0;
  EXPECT_EQ(p.taps().heaviest(), 6u);
  EXPECT_FLOAT_EQ(p.taps().weights[0], 1.0f);
}

TEST(LookBack, KeepsTheBackground) {
  MovedPlane p;
  p.plane.instance.assign(16, kNoSurface);
  p.plane.before.assign(16, kNoSurface);
  p.reject_reasons.assign(16, number(empty));  // the background has no samples to project
  EXPECT_TRUE(p.taps().valid);
}

/// Sixteen pixels and their votes. Every pixel of the previous frame has one stored sample.
struct Sources {
  explicit Sources(const MovedPlane& plane) {
    kernel.votes = view_of(votes);
    kernel.stored_before = view_of(stored_before);
    kernel.pixels_before = view_of(pixels_before);
    kernel.limits_before = view_of(plane.limits);
    kernel.look_back = plane.look_back();
    kernel.hits = view_of(hits);
    kernel.stored = mutable_view_of(stored);
    kernel.pixels = mutable_view_of(pixels);
    kernel.limits = mutable_view_of(limits);
    kernel.sources = mutable_view_of(sources);
    kernel.kept = mutable_view_of(goes_on);
    kernel.reasons = mutable_view_of(reasons);
    kernel.width = 4;
  }

  std::vector<uint64_t> votes = std::vector<uint64_t>(16, kNoVote);
  std::vector<Hit> hits = std::vector<Hit>(16);
  std::vector<StoredSample> stored_before = std::vector<StoredSample>(16);
  std::vector<StoredPixel> pixels_before = std::vector<StoredPixel>(16);
  std::vector<StoredSample> stored = std::vector<StoredSample>(16);
  std::vector<StoredPixel> pixels = std::vector<StoredPixel>(16);
  std::vector<uint32_t> limits = std::vector<uint32_t>(16), sources = std::vector<uint32_t>(16);
  std::vector<uint32_t> goes_on = std::vector<uint32_t>(16), reasons = std::vector<uint32_t>(16);
  SourceKernel kernel;
};

TEST(LookBack, FillsOnlyWhereTheReasonConcernsAnotherSurface) {
  const MovedPlane plane;
  for (const RejectReason reason : {empty, occluded, mixed, view_dependent, near_specular, relit}) {
    Sources s(plane);
    if (reason != empty) s.votes[7] = rejection_of(1, reason);
    s.kernel(3, 1);
    const bool fills = reason == empty || reason == occluded || reason == mixed;
    EXPECT_EQ(s.reasons[7], number(fills ? filled : reason));
    EXPECT_EQ(s.goes_on[7], fills ? 1u : 0u);
    EXPECT_EQ(s.sources[7], fills ? 6u : kNoSource);
    EXPECT_EQ(s.limits[7], fills ? 100u : 0u);
  }
}

TEST(LookBack, AVoteComesFirst) {
  const MovedPlane plane;
  Sources s(plane);
  s.votes[7] = vote_of(1, 11);
  s.kernel(3, 1);
  EXPECT_EQ(s.sources[7], 11u);
  EXPECT_EQ(s.reasons[7], number(none));
}

TEST(LookBack, AVoteOfAnotherSurfaceIsReplaced) {
  const MovedPlane plane;
  Sources s(plane);
  s.votes[7] = vote_of(1, 11);
  s.stored_before[11].hit.instance = 5;  // this frame's sample has no hit
  s.kernel(3, 1);
  EXPECT_EQ(s.sources[7], 6u);
  EXPECT_EQ(s.reasons[7], number(filled));
  s.kernel.look_back = {};
  s.kernel(3, 1);
  EXPECT_EQ(s.sources[7], kNoSource);
  EXPECT_EQ(s.reasons[7], number(other_surface));
}

TEST(LookBack, InterpolatesFilledPixelsOnly) {
  const MovedPlane plane;
  testing::History before;
  before.mean[6] = Rgb(2);
  before.mean[7] = Rgb(4);
  before.samples[7] = 5;
  testing::History now;
  std::vector<uint32_t> reasons(16, number(none));
  reasons[7] = number(filled);
  FillKernel kernel;
  kernel.look_back = plane.look_back();
  kernel.reasons = view_of(reasons);
  kernel.history = {.before = before.view(), .now = now.mutable_view()};
  kernel.width = 4;
  for (uint32_t i = 0; i < 16; ++i) kernel(i % 4, i / 4);
  for (uint32_t i = 0; i < 16; ++i) {
    EXPECT_EQ(now.samples[i], i == 7 ? 5u : 9u);
    EXPECT_EQ(now.mean[i], Rgb(3)) << "between 2 and 4, or untouched";
  }
}

TEST(CellsHistory, LeavesCellsThatLookDifferentToThisFrame) {
  MovedPlane plane;
  const std::vector<Rgb> before(16, Rgb(2));
  const std::vector<uint32_t> samples_before(16, 9);
  std::vector<uint32_t> sources(16, 1);
  std::vector<uint32_t> reasons(16, number(none));
  std::vector<Rgb> mean(16, Rgb(5)), now(16, Rgb(7));
  std::vector<uint32_t> samples(16, 7);
  sources[0] = kNoSource;
  reasons[2] = number(looked_up);
  reasons[7] = number(filled);
  CellsHistoryKernel kernel;
  kernel.look_back = plane.look_back();
  kernel.sources = view_of(sources);
  kernel.reasons = view_of(reasons);
  kernel.limits = view_of(plane.limits);
  kernel.before = view_of(before);
  kernel.samples_before = view_of(samples_before);
  kernel.mean = mutable_view_of(mean);
  kernel.now = mutable_view_of(now);
  kernel.samples = mutable_view_of(samples);
  kernel.max_samples = 8;
  kernel.width = 4;
  const auto expect_part = [&](uint32_t pixel, float part, uint32_t count, float whole) {
    kernel(pixel % 4, pixel / 4);
    EXPECT_EQ(now[pixel], Rgb(part)) << pixel;
    EXPECT_EQ(samples[pixel], count) << pixel;
    EXPECT_EQ(mean[pixel], Rgb(whole)) << pixel;
  };
  expect_part(0, 0, 0, 5);
  expect_part(1, 2, 8, 5);
  expect_part(2, 0, 0, 3);
  expect_part(7, 2, 8, 5);
  plane.reject_reasons[7] = number(looked_up);  // one of two taps
  expect_part(7, 0, 0, 3);
}

}  // namespace
}  // namespace relume
