#include "techniques/guiding/markov_chain/guide_recorder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "techniques/guiding/markov_chain/testing/random_states.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"

namespace relume {
namespace {

using testing::point_at;

/// The members of a path that recorders read.
struct TestPath {
  Rgb throughput{1};
  Rgb radiance{0};
  bool delta = false;
  uint32_t bounce = 0;
};

const Vec3 kUp(0, 1, 0);
const Vec3 kAside = glm::normalize(Vec3(0.6f, 0.8f, 0));

/// Records of `pixels` pixels with two vertices each.
class GuideRecorderTest : public ::testing::Test {
 protected:
  static constexpr uint32_t kPixels = 4000;

  GuideRecorder recorder(uint32_t pixel = 0) {
    recording_.guide = {.grid = table_.grid, .table = table_.view(), .frame = 7};
    recording_.out = {mutable_view_of(records_), 2, kPixels};
    GuideRecorder recorder;
    recorder.recording = &recording_;
    recorder.pixel = pixel;
    return recorder;
  }

  /// A sample of half the weight towards `wi`, and the path after it.
  static BsdfSample sampled(const Vec3& wi, TestPath& path) {
    BsdfSample s;
    s.wi = wi;
    s.weight = Rgb(0.5f);
    s.pdf_w = 0.4f;
    s.valid = true;
    path.throughput *= s.weight;
    ++path.bounce;
    return s;
  }

  const MarkovRecord<GuideState>& record(uint32_t vertex, uint32_t pixel = 0) const {
    return records_[vertex * kPixels + pixel];
  }
  bool has_record(uint32_t vertex, uint32_t pixel = 0) const {
    return record(vertex, pixel).cells[0].slot != kNoSlot || record(vertex, pixel).cells[1].slot != kNoSlot;
  }

  testing::FilledTable<GuideState> table_;
  std::vector<MarkovRecord<GuideState>> records_ = std::vector<MarkovRecord<GuideState>>(2 * size_t{kPixels});
  GuideRecording recording_;
  SurfacePoint floor_ = point_at({1, 0, 2}, kUp);
};

TEST_F(GuideRecorderTest, KeepsTargetScoreAndMotion) {
  GuideRecorder r = recorder();
  TestPath path;
  path.radiance = Rgb(1);
  const BsdfSample s = sampled(kAside, path);
  r.scattered(floor_, s, path);
  SurfacePoint lamp = point_at(floor_.position + 3.0f * kAside, -kUp);
  lamp.previous_position -= Vec3(0, 0.5f, 0);
  r.hit_surface(lamp, path);
  path.radiance += path.throughput * 4.0f;
  r.emitted(path, false);
  r.finished(path);
  const MarkovRecord<GuideState>& found = record(0);
  EXPECT_NEAR(found.state.weight, 2, 1e-5f);  // radiance 4 times the weight
  EXPECT_NEAR(glm::distance(mean_target(found.state), lamp.position), 0, 1e-4f);
  EXPECT_EQ(found.state.count, 1);
  EXPECT_EQ(found.state.frame, 7u);
  EXPECT_EQ(unpack_motion(found.state.motion[1]), 0.5f);
  EXPECT_FALSE(table_.grid.is_static(found.cells[0]));
  EXPECT_TRUE(table_.grid.is_static(found.cells[1]));
  EXPECT_FALSE(has_record(1));
}

TEST_F(GuideRecorderTest, LightFromInfinityHasADistantTarget) {
  GuideRecorder r = recorder();
  TestPath path;
  r.scattered(floor_, sampled(kAside, path), path);
  path.radiance += path.throughput;
  r.emitted(path, false);
  r.finished(path);
  for (const Vec3& p : {floor_.position, floor_.position + Vec3(table_.grid.edge_at(floor_.position), 0, 0)})
    EXPECT_GT(glm::dot(glm::normalize(mean_target(record(0).state) - p), kAside), 0.99999f);
}

TEST_F(GuideRecorderTest, ExcludesWhatNextEventEstimationCouldSample) {
  GuideRecorder r = recorder();
  TestPath path;
  r.scattered(floor_, sampled(kAside, path), path);
  path.radiance += path.throughput * 9.0f;
  r.emitted(path, true);
  r.finished(path);
  EXPECT_FALSE(has_record(0));
}

TEST_F(GuideRecorderTest, DeltaLobesLeaveNoRecord) {
  GuideRecorder r = recorder();
  TestPath path;
  path.delta = true;
  r.scattered(floor_, sampled(kAside, path), path);
  r.hit_surface(point_at({5, 0, 0}, kUp), path);
  path.delta = false;
  r.scattered(point_at({5, 0, 0}, kUp), sampled(kAside, path), path);
  path.radiance += path.throughput;
  r.finished(path);
  EXPECT_FALSE(has_record(0));
  EXPECT_TRUE(has_record(1));
}

TEST_F(GuideRecorderTest, LaterLightCountsForAllEarlierVertices) {
  GuideRecorder r = recorder();
  TestPath path;
  r.scattered(floor_, sampled(kAside, path), path);
  const SurfacePoint wall = point_at({5, 1, 0}, Vec3(1, 0, 0));
  r.hit_surface(wall, path);
  r.scattered(wall, sampled(Vec3(1, 0, 0), path), path);
  path.radiance += path.throughput * 8.0f;  // throughput 1/4
  r.finished(path);
  EXPECT_NEAR(record(0).state.weight, 2, 1e-5f);
  EXPECT_NEAR(record(1).state.weight, 4, 1e-5f);
}

TEST_F(GuideRecorderTest, ReservoirsMayRebaseThePath) {
  GuideRecorder r = recorder();
  TestPath path;
  path.radiance = Rgb(3);
  r.scattered(floor_, sampled(kAside, path), path);
  r.hit_surface(point_at({5, 1, 0}, kUp), path);
  r.rebased(path.radiance, path.throughput);
  path.throughput = Rgb(1);
  path.radiance = Rgb(4);
  r.finished(path);
  EXPECT_NEAR(record(0).state.weight, 2, 1e-5f);
}

TEST_F(GuideRecorderTest, AcceptsInProportionToTheScore) {
  // All drawn states have weight 4; a score of 1 is accepted with probability 1/4.
  table_.fill(floor_, [](uint32_t) {
    GuideState s = testing::narrow_state(Vec3(-12, 20, 8));
    s.weight = s.cosine = 4;
    return s;
  });
  int accepted = 0;
  for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    GuideRecorder r = recorder(pixel);
    TestPath path;
    r.scattered(floor_, sampled(kAside, path), path);
    path.radiance += path.throughput * 2.0f;
    r.finished(path);
    if (!has_record(0, pixel)) continue;
    ++accepted;
    ASSERT_EQ(record(0, pixel).state.count, 1);  // the BSDF chose the direction: a new chain
  }
  EXPECT_NEAR(accepted, kPixels / 4.0, 5 * std::sqrt(kPixels * 0.25 * 0.75));
}

TEST_F(GuideRecorderTest, ADirectionBelongsToItsLobeInProportionToTheDensities) {
  const Vec3 target = floor_.position + 2.0f * kAside;
  table_.fill(floor_, [&](uint32_t) { return testing::narrow_state(target); });
  int continued = 0;
  for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    GuideRecorder r = recorder(pixel);
    TestPath path;
    BsdfSample s = sampled(kAside, path);
    s.guide_pdf_w = 0.3f;
    s.bsdf_pdf_w = 1;
    s.pdf_w = recording_.guide.bsdf_fraction * s.bsdf_pdf_w + (1 - recording_.guide.bsdf_fraction) * s.guide_pdf_w;
    r.scattered(floor_, s, path);
    path.radiance += path.throughput * 1000.0f;
    r.finished(path);
    ASSERT_TRUE(has_record(0, pixel));
    continued += record(0, pixel).state.count == 1001 ? 1 : 0;
  }
  const double share = 0.85 * 0.3 / (0.15 + 0.85 * 0.3);
  EXPECT_NEAR(continued, share * kPixels, 5 * std::sqrt(kPixels * share * (1 - share)));
}

TEST_F(GuideRecorderTest, ChainsEndWhereTheirLightHasVanished) {
  table_.fill(floor_, [&](uint32_t) { return testing::narrow_state(floor_.position + 2.0f * kAside); });
  for (const bool recovers : {true, false}) {
    GuideRecorder r = recorder();
    recording_.recovers = recovers;
    TestPath path;
    BsdfSample s = sampled(kAside, path);
    s.guide_pdf_w = s.pdf_w = 100;
    s.pdf_w *= 1 - recording_.guide.bsdf_fraction;  // the BSDF does not sample the direction
    r.scattered(floor_, s, path);
    r.hit_surface(point_at(floor_.position + 2.0f * kAside, kUp), path);
    r.finished(path);
    ASSERT_EQ(has_record(0), recovers);
    if (!recovers) continue;
    EXPECT_EQ(record(0).state.weight, 0.0f);
    EXPECT_EQ(table_.view().load(record(0).cells[0]).weight, 1.0f) << "the cell of the chain";
    EXPECT_EQ(record(0).cells[1].slot, kNoSlot);
  }
}

TEST_F(GuideRecorderTest, SamplesThatAreNotFiniteLeaveNoRecord) {
  for (const float value : {kInfinity, std::nanf("")}) {
    GuideRecorder r = recorder();
    TestPath path;
    r.scattered(floor_, sampled(kAside, path), path);
    path.radiance += Rgb(value);
    r.finished(path);
    EXPECT_FALSE(has_record(0));
  }
}

}  // namespace
}  // namespace relume
