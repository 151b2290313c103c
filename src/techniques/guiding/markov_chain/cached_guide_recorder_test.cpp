#include "techniques/guiding/markov_chain/cached_guide_recorder.h"

#include <gtest/gtest.h>

#include <vector>

#include "techniques/spatial/markov_grid/testing/filled_table.h"

namespace relume {
namespace {

/// The members of a path that recorders read.
struct TestPath {
  Rgb throughput{1};
  Rgb radiance{0};
  bool delta = false;
  uint32_t bounce = 0;
};

/// One path among empty chains, so that each score above 0 starts one.
class CachedGuideRecorderTest : public ::testing::Test {
 protected:
  static constexpr uint32_t kVertices = 3;

  CachedGuideRecorderTest() {
    recording_.guide = {.grid = table_.grid, .table = table_.view(), .frame = 7};
    recording_.out = {mutable_view_of(records_), kVertices, 1};
    recorder_.recording = &recording_;
  }

  /// Leaves the vertex; `weight`: factor of the throughput.
  void leave(float weight, bool delta = false) {
    BsdfSample s;
    s.wi = glm::normalize(Vec3(0.6f, 0.8f, 0));
    s.weight = Rgb(weight);
    s.pdf_w = 0.5f;
    s.delta = delta;
    s.valid = true;
    path_.throughput *= weight;
    path_.delta = delta;
    ++path_.bounce;
    recorder_.scattered(point_, s, path_);
  }
  /// Adds light to the path.
  void find(float light) { path_.radiance += path_.throughput * light; }
  /// Sets the unit of the path as a cache does.
  void rebase(float throughput, float unit) {
    recorder_.rebased(path_.radiance, Rgb(unit));
    path_.radiance = Rgb(0);
    path_.throughput = Rgb(throughput);
  }
  /// Score of the recorded direction of a vertex; 0 without a record.
  float score(uint32_t vertex) const {
    return records_[vertex].cells[0].slot == kNoSlot ? 0.0f : records_[vertex].state.weight;
  }

  testing::FilledTable<GuideState> table_;
  std::vector<MarkovRecord<GuideState>> records_ = std::vector<MarkovRecord<GuideState>>(kVertices);
  GuideRecording recording_;
  CachedGuideRecorder recorder_;
  SurfacePoint point_ = testing::point_at({1, 0, 2}, Vec3(0, 1, 0));
  TestPath path_;
};

TEST_F(CachedGuideRecorderTest, CellsReplaceTheRestOfThePath) {
  leave(0.5f);
  find(4);
  rebase(1, 0.5f);
  recorder_.ended_in_cell(Rgb(0.5f * 3));
  find(100);  // next event estimation, which the cell contains
  leave(0.5f);
  find(6);
  rebase(1, 0.25f);
  recorder_.ended_in_cell(Rgb(0.25f * 8));
  find(100);
  leave(1);
  find(9);
  recorder_.finished(path_);
  EXPECT_NEAR(score(0), 0.5f * (4 + 3), 1e-4f);
  EXPECT_NEAR(score(1), 0.5f * (6 + 8), 1e-4f);
  EXPECT_NEAR(score(2), 9, 1e-4f);
}

TEST_F(CachedGuideRecorderTest, DirectionsLeadToTheCellInWhichThePathEnds) {
  leave(0.5f);
  const SurfacePoint wall = testing::point_at({5, 1, 0}, Vec3(-1, 0, 0));
  recorder_.hit_surface(wall, path_);
  rebase(1, 0.5f);
  recorder_.ended_in_cell(Rgb(0.5f * 3));
  recorder_.finished(path_);
  EXPECT_NEAR(score(0), 0.5f * 3, 1e-4f);
  EXPECT_NEAR(glm::distance(mean_target(records_[0].state), wall.position), 0, 1e-4f);
  EXPECT_EQ(score(1), 0.0f) << "no direction was sampled there";
}

TEST_F(CachedGuideRecorderTest, LightOfDeltaLobesAddsToTheCell) {
  leave(0.5f);
  rebase(1, 0.5f);
  recorder_.ended_in_cell(Rgb(0.5f * 3));
  find(100);
  leave(0.25f, true);
  rebase(0.25f, 0.5f);
  find(8);
  recorder_.finished(path_);
  EXPECT_NEAR(score(0), 0.5f * (3 + 0.25f * 8), 1e-4f);
  EXPECT_EQ(score(1), 0.0f) << "a delta lobe";
}

TEST_F(CachedGuideRecorderTest, DeltaLobesAddNothingToEarlierCells) {
  leave(0.5f);
  rebase(1, 0.5f);
  recorder_.ended_in_cell(Rgb(0.5f * 3));
  leave(0.5f);
  rebase(1, 0.25f);
  recorder_.ended_in_cell(Rgb(0.25f * 2));
  leave(0.25f, true);
  rebase(0.25f, 0.25f);
  find(8);
  recorder_.finished(path_);
  EXPECT_NEAR(score(0), 0.5f * 3, 1e-4f);
  EXPECT_NEAR(score(1), 0.5f * (2 + 0.25f * 8), 1e-4f);
}

TEST_F(CachedGuideRecorderTest, MirrorsBehindACellAddNothingToIt) {
  leave(0.5f);
  rebase(1, 0.5f);
  recorder_.ended_in_cell(Rgb(0.5f * 3));
  leave(0.5f);
  leave(0.5f, true);  // a mirror, which has no cell
  find(8);
  recorder_.finished(path_);
  EXPECT_NEAR(score(0), 0.5f * 3, 1e-4f);
  EXPECT_NEAR(score(1), 0.5f * (0.5f * 8), 1e-4f);
}

TEST_F(CachedGuideRecorderTest, VerticesWithoutARecordPassOnTheirCell) {
  recording_.out.vertices = 1;
  leave(0.5f);
  leave(0.5f);
  rebase(1, 0.25f);
  recorder_.ended_in_cell(Rgb(0.25f * 4));
  recorder_.finished(path_);
  EXPECT_NEAR(score(0), 0.5f * (0.5f * 4), 1e-4f);
}

}  // namespace
}  // namespace relume
