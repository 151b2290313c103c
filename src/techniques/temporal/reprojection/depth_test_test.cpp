// Votes and moves of buffers, without a scene.
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "framebuffer/testing/moment_vectors.h"
#include "techniques/temporal/reprojection/reprojection.h"

namespace relume {
namespace {

TEST(DepthTest, AVoteWinsOverEveryRejection) {
  std::vector<uint64_t> vote{kNoVote};
  atomic_min(&vote[0], rejection_of(5.0f, RejectReason::relit));
  atomic_min(&vote[0], rejection_of(1.0f, RejectReason::occluded));
  EXPECT_EQ(reason_of(vote[0]), RejectReason::occluded);
  EXPECT_FALSE(is_vote(vote[0]));
  atomic_min(&vote[0], vote_of(9.0f, 4));
  EXPECT_EQ(reason_of(vote[0]), RejectReason::none);
}

TEST(DepthTest, AVoteWithoutTheLightOfCellsKeepsItsSample) {
  const uint64_t vote = vote_of(2.0f, 5u | kLooksUp);
  EXPECT_TRUE(is_vote(vote));
  EXPECT_EQ(sample_of(vote), 5u);
  EXPECT_EQ(reason_of(vote), RejectReason::looked_up);
  EXPECT_LT(vote, vote_of(3.0f, 0));
  EXPECT_LT(vote_of(2.0f, 5), vote);
  EXPECT_EQ(sample_of(vote_of(2.0f, 5)), 5u);
}

TEST(DepthTest, NearestVoteWinsThenTheLowestSample) {
  EXPECT_LT(vote_of(1.0f, 9), vote_of(2.0f, 3));
  EXPECT_LT(vote_of(1.0f, 3), vote_of(1.0f, 9));
  std::vector<uint64_t> vote{kNoVote};
  for (const uint64_t c : {vote_of(3.0f, 1), vote_of(2.0f, 7), vote_of(2.0f, 5), vote_of(9.0f, 0)})
    atomic_min(&vote[0], c);
  EXPECT_EQ(vote[0], vote_of(2.0f, 5));
}

TEST(DepthTest, OneRelitSampleEndsTheHistoryThatOthersVoteFor) {
  const std::vector<uint64_t> votes{vote_of(1, 3), vote_of(1, 0)};  // two samples per pixel
  const std::vector<uint32_t> limits_before{16, 0};
  std::vector<StoredSample> stored(4);
  std::vector<StoredPixel> pixels(2);
  std::vector<uint32_t> limits(2), sources(2), kept(2), reasons(2);
  const std::vector<Hit> hits(2);
  SourceKernel kernel;
  kernel.votes = view_of(votes);
  kernel.stored_before = view_of(stored);
  kernel.pixels_before = view_of(pixels);
  kernel.limits_before = view_of(limits_before);
  kernel.hits = view_of(hits);
  kernel.stored = mutable_view_of(stored);
  kernel.pixels = mutable_view_of(pixels);
  kernel.limits = mutable_view_of(limits);
  kernel.sources = mutable_view_of(sources);
  kernel.kept = mutable_view_of(kept);
  kernel.reasons = mutable_view_of(reasons);
  kernel.capacity = 2;
  kernel.width = 2;
  for (uint32_t x = 0; x < 2; ++x) kernel(x, 0);
  EXPECT_EQ(sources, (std::vector<uint32_t>{kNoSource, 0}));
  EXPECT_EQ(kept, (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(static_cast<RejectReason>(reasons[0]), RejectReason::relit);
}

TEST(DepthTest, MovesBuffersAndClearsPixelsWithoutASource) {
  const std::vector<float> before{1, 2, 3};
  std::vector<float> now(3, 9);
  const std::vector<uint32_t> sources{2, kNoSource, 0};
  const MoveKernel<float> kernel{view_of(before), mutable_view_of(now), view_of(sources), 3};
  for (uint32_t x = 0; x < 3; ++x) kernel(x, 0);
  EXPECT_EQ(now, (std::vector<float>{3, 0, 1}));
}

TEST(DepthTest, MovesMomentsOrKeepsThemInTheirPlaces) {
  testing::MomentVectors before(3);
  before.samples = {1, 2, 3};
  testing::MomentVectors now(3, {Rgb(9), 9, 9, 9});
  const std::vector<uint32_t> sources{2, kNoSource, 0};
  MoveMomentsKernel kernel{before.view(), now.mutable_view(), view_of(sources), 3};
  for (uint32_t x = 0; x < 3; ++x) kernel(x, 0);
  EXPECT_EQ(now.samples, (std::vector<uint32_t>{3, 0, 1}));
  EXPECT_EQ(now.m2, (std::vector<float>{0, 0, 0}));
  kernel.sources = {};
  for (uint32_t x = 0; x < 3; ++x) kernel(x, 0);
  EXPECT_EQ(now.samples, before.samples);
}

TEST(DepthTest, LimitHoldsForThePixelAndForAll) {
  testing::MomentVectors moments(3, {Rgb(1), 5, 15, 40});
  const std::vector<uint32_t> limits{7, 100, 40};
  const LimitKernel kernel{moments.mutable_view(), view_of(limits), 11, 3};
  for (uint32_t x = 0; x < 3; ++x) kernel(x, 0);
  EXPECT_EQ(moments.samples, (std::vector<uint32_t>{7, 11, 11}));
}

TEST(DepthTest, LimitHoldsForTheSplatImage) {
  testing::MomentVectors moments(2, {Rgb(0), 5, 15, 3});
  std::vector<float> light_paths{20, 7};
  LimitKernel kernel{moments.mutable_view(), {}, 11, 2};
  kernel.light_paths = mutable_view_of(light_paths);
  kernel(0, 0);
  kernel(1, 0);
  EXPECT_EQ(light_paths, (std::vector<float>{11, 7}));
  EXPECT_EQ(moments.samples, (std::vector<uint32_t>{3, 3}));
}

TEST(DepthTest, LimitHoldsForTheCausticLayer) {
  testing::MomentVectors moments(2, {Rgb(0), 5, 15, 3});
  testing::MomentVectors layer(2, {Rgb(1), 19, 0, 20});
  layer.samples[1] = 7;
  LimitKernel kernel{moments.mutable_view(), {}, 11, 2};
  kernel.caustics = layer.mutable_view();
  kernel(0, 0);
  kernel(1, 0);
  EXPECT_EQ(layer.samples, (std::vector<uint32_t>{11, 7}));
  EXPECT_EQ(layer.m2, (std::vector<float>{10, 19}));
  EXPECT_EQ(moments.samples, (std::vector<uint32_t>{3, 3}));
}

TEST(DepthTest, PixelsOfLargeImagesHaveExactIndices) {
  CameraView camera;
  camera.resolution = {7680, 4320};  // twice as many pixels as floats can number
  EXPECT_EQ(pixel_at(camera, {1234.5f, 4319.5f}), 4319u * 7680u + 1234u);
  EXPECT_EQ(pixel_at(camera, {1235.5f, 4319.5f}), 4319u * 7680u + 1235u);
  EXPECT_EQ(pixel_at(camera, camera.resolution), 7680u * 4320u - 1u);
  EXPECT_EQ(pixel_at(camera, Vec2(kInfinity)), 7680u * 4320u - 1u);
  EXPECT_EQ(pixel_at(camera, {1234.5f, -3e9f}), 1234u);
  EXPECT_EQ(pixel_at(camera, {std::numeric_limits<float>::quiet_NaN(), -kInfinity}), 0u);
}

}  // namespace
}  // namespace relume
