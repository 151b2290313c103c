// Tests where camera paths end, and how much light of later vertices cells receive.
#include "techniques/radiance_cache/sharc/cell_ends.h"

#include <gtest/gtest.h>

#include <vector>

#include "techniques/radiance_cache/sharc/cell_update.h"
#include "techniques/spatial/hash_grid/hash_grid_table.h"
#include "techniques/spatial/hash_grid/testing/grid_camera.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"

namespace relume {
namespace {

TEST(SharcGuards, HideCellsSmallerThanSegmentAndCone) {
  EXPECT_TRUE(hides(2, 3, 1));
  EXPECT_TRUE(hides(1, 1, 1));
  EXPECT_FALSE(hides(0.9f, 3, 1));
  EXPECT_FALSE(hides(2, 0.9f, 1));
  EXPECT_FALSE(hides(2, 0, 1));  // seen directly or in a mirror
}

TEST(SharcGuards, ConesAreThoseOfTheLobes) {
  EXPECT_EQ(lobe_spread(0), 0.0f);
  EXPECT_NEAR(lobe_spread(0.1f), 0.0710669f, 1e-6f);  // √(0.005 / 0.99)
  EXPECT_NEAR(lobe_spread(0.5f), 0.408248f, 1e-5f);   // √(0.125 / 0.75)
  EXPECT_EQ(lobe_spread(1), 1000.0f);                 // diffuse
}

/// A cell of mean 1.
CellMoments cell_of(float variance, float count) {
  CellMoments cell;
  cell.mean = Rgb(1);
  cell.mean_square = sqr(luminance(cell.mean)) + variance * (count - 1) / count;
  cell.count = count;
  return cell;
}

TEST(CellEnds, KnownCellsEndPaths) {
  CellEnds ends;
  ends.cells.grid.rule.min_count = 4;
  EXPECT_FALSE(ends.accepts({}));
  EXPECT_FALSE(ends.accepts(cell_of(0, 3)));
  EXPECT_TRUE(ends.accepts(cell_of(0, 4)));
  EXPECT_TRUE(ends.accepts(cell_of(100, 4)));
}

TEST(CellEnds, LargeVarianceKeepsPathsAlive) {
  CellEnds ends;
  ends.by_variance = true;
  ends.variance = 0.5f;
  EXPECT_TRUE(ends.accepts(cell_of(0.4f, 100)));
  EXPECT_FALSE(ends.accepts(cell_of(0.6f, 100)));
  EXPECT_FALSE(ends.accepts(cell_of(0.4f, 15))) << "too few samples to know the variance";
  CellMoments bright = cell_of(0.4f, 100);
  bright.mean *= 10.0f;
  bright.mean_square *= 100.0f;
  EXPECT_TRUE(ends.accepts(bright)) << "the variance is relative";
  CellMoments black;
  black.count = 100;
  EXPECT_FALSE(ends.accepts(black)) << "bright samples may be rare";
}

constexpr float kAlbedo = 0.8f;

/// Eight leaves over the cube from −4 to 4.
OctreeView eight_leaves() {
  static constexpr uint32_t kNodes[1] = {0xffu};
  return {{kNodes, 1}, Vec3(-4), static_cast<float>(1u << kMaxOctreeDepth) / 8};
}

HashGridSettings grid_settings() {
  HashGridSettings settings;
  settings.jitter = false;
  settings.min_count = 1;
  return settings;
}

/// A point that faces the camera of grid_camera().
SurfacePoint point_at(const Vec3& position) {
  SurfacePoint sp{};
  sp.position = sp.previous_position = position;
  sp.ng = sp.wo = Vec3(0, 0, 1);
  sp.frame = make_frame(sp.ng);
  sp.wo_local = Vec3(0, 0, 1);
  sp.bsdf.lobe_count = 1;
  sp.bsdf.lobes[0].kind = LobeKind::lambert;
  sp.bsdf.lobes[0].color = Rgb(kAlbedo);
  sp.bsdf.lobes[0].weight = 1;
  return sp;
}

/// A path with two vertices, of which the second has a known cell, and the records of both for regions and chains.
class EndingPath : public ::testing::Test {
 protected:
  using Policies = PathPolicies<CachedPathRecorder, CachedChainPolicy, CellEnd>;

  EndingPath() : grid_(grid_settings(), 64), records_(2), directions_(2) {
    Backend backend(1);
    const SharcCells cells{grid_.view(grid_camera())};
    cells.grid.insert(cells.point(second_, Vec2(0.5f)), Rgb(3), 1.0f, 0.0f, kNoCell, true);
    grid_.end_frame(backend);
    recording_.octree = recording_.lookup.tree = eight_leaves();
    recording_.samples = mutable_view_of(records_);
    recording_.vertices = 2;
    recording_.pixels = 1;
    chains_.guide.guide.grid = testing::FilledTable<GuideState>().grid;  // of an empty table
    chains_.guide.out = {mutable_view_of(directions_), 2, 1};
  }

  /// Traces the path, which leaves the first vertex by `s` and then finds emission 2. Returns whether it continues at
  /// the second vertex.
  bool trace(const SurfacePoint& first, const BsdfSample& s) {
    CellEnds ends;
    ends.cells.grid = grid_.view(grid_camera());
    const SampleIndex index;
    const CachedRecordingOutput recording{recording_};
    const CachedChainOutput chains{chains_};
    Policies policies{recording.policy(index, 0, 0, 0),
                      {chains.policy(index, 0, 0, 0), {ends.policy(index, 0, 0, 0), {}}}};
    return trace_with(policies, first, s);
  }

  /// The same for a path from which reservoirs take a sample.
  bool trace_sample(IndirectSample& sample) {
    CellEnds ends;
    ends.cells.grid = grid_.view(grid_camera());
    const SampleIndex index;
    const CachedRecordingOutput recording{recording_};
    const IndirectSampleOutput samples{view_of_one(sample)};
    PathPolicies<CachedPathRecorder, IndirectSamplePolicy, CellEnd> policies{
        recording.policy(index, 0, 0, 0), {samples.policy(index, 0, 0, 0), {ends.policy(index, 0, 0, 0), {}}}};
    return trace_with(policies, first_, {});
  }

  template <typename Traced>
  bool trace_with(Traced& policies, const SurfacePoint& first, BsdfSample s) {
    path_ = {};
    SurfacePoint sp = first;
    EXPECT_TRUE(policies.arrived(sp, path_));
    EXPECT_TRUE(policies.goes_on(path_)) << "paths do not end at the first surface";
    s.wi = glm::normalize(second_.position - first.position);
    path_.ray = {first.position, s.wi};
    path_.pdf_w = s.pdf_w = 0.5f;
    s.weight = Rgb(0.25f);
    path_.throughput *= s.weight;
    path_.delta = false;
    ++path_.bounce;
    policies.scattered(sp, s, path_);
    sp = second_;
    policies.hit_surface(sp, path_);
    path_.radiance += path_.throughput * 2.0f;
    EXPECT_TRUE(policies.arrived(sp, path_));
    const bool continues = policies.goes_on(path_);
    policies.finished(path_);
    return continues;
  }

  const SurfacePoint first_ = point_at({-1, 0, -3});
  const SurfacePoint second_ = point_at({1, 0, -2});
  HashGrid grid_;
  std::vector<VertexSample> records_;
  PathRecording recording_;
  std::vector<MarkovRecord<GuideState>> directions_;
  ChainOutput chains_;
  PathState path_;
};

TEST_F(EndingPath, RecordsTheMeanOfTheCell) {
  EXPECT_FALSE(trace(first_, {}));
  const float arriving = 2 + kAlbedo * 3;
  EXPECT_NEAR(path_.radiance.g, 0.25f * arriving, 1e-4f);
  EXPECT_EQ(records_[0].weight, 1.0f);
  EXPECT_NEAR(records_[0].value, arriving * shading_cosine(first_, path_.ray.direction) / 0.5f, 1e-4f);
  EXPECT_NE(records_[1].region, kNoRegion);
  EXPECT_EQ(records_[1].weight, 0.0f) << "no direction was sampled there";
}

TEST_F(EndingPath, TeachesChainsTheMeanOfTheCell) {
  EXPECT_FALSE(trace(first_, {}));
  EXPECT_NE(directions_[0].cells[0].slot, kNoSlot);
  EXPECT_NEAR(directions_[0].state.weight, 0.25f * (2 + kAlbedo * 3), 1e-4f);
  EXPECT_NEAR(glm::distance(mean_target(directions_[0].state), second_.position), 0, 1e-4f);
  EXPECT_EQ(directions_[1].cells[0].slot, kNoSlot) << "no direction was sampled there";
}

/// The sample has the light of the cell, without the throughput of the pixel. The path keeps the emission, and records
/// both.
TEST_F(EndingPath, GivesTheMeanOfTheCellToTheSample) {
  IndirectSample sample;
  EXPECT_FALSE(trace_sample(sample));
  EXPECT_NEAR(path_.radiance.g, 0.25f * 2, 1e-4f);
  EXPECT_NEAR(sample.vertex.radiance.g, kAlbedo * 3, 1e-4f);
  EXPECT_NEAR(sample.weight, 1 / 0.5f, 1e-4f);
  EXPECT_NEAR(records_[0].value, (2 + kAlbedo * 3) * shading_cosine(first_, path_.ray.direction) / 0.5f, 1e-4f);
  EXPECT_EQ(records_[1].weight, 0.0f);
}

TEST_F(EndingPath, GuidedDirectionsHaveTheConeOfTheNarrowestLobe) {
  SurfacePoint polished = first_;
  polished.bsdf.lobe_count = 2;
  polished.bsdf.lobes[1] = polished.bsdf.lobes[0];
  polished.bsdf.lobes[1].kind = LobeKind::reflection;
  polished.bsdf.lobes[1].alpha = 1e-3f;
  EXPECT_EQ(narrowest_alpha(first_.bsdf), 1.0f);
  EXPECT_EQ(narrowest_alpha(polished.bsdf), 1e-3f);
  EXPECT_FALSE(trace(polished, {})) << "a sample of the diffuse lobe";
  BsdfSample guided;
  guided.bsdf_pdf_w = guided.guide_pdf_w = 0.5f;
  EXPECT_FALSE(trace(first_, guided));
  EXPECT_TRUE(trace(polished, guided));
  EXPECT_EQ(records_[1].weight, 1.0f);
}

TEST(SharcClamp, LimitsRiseWithConfidence) {
  EXPECT_EQ(clamped_share(10, cell_of(0, 2), 1000), 1.0f);
  EXPECT_NEAR(clamped_share(10, cell_of(0, 2.001f), 20), 0.25f, 1e-3f);  // 5 · mean
  EXPECT_NEAR(clamped_share(10, cell_of(0, 7), 15), 0.5f, 1e-6f);        // 7.5 · mean
  EXPECT_NEAR(clamped_share(10, cell_of(0, 12), 20), 0.5f, 1e-6f);       // 10 · mean
  EXPECT_EQ(clamped_share(10, cell_of(0, 500), 9.9f), 1.0f);
  CellMoments black;
  black.count = 100;
  EXPECT_EQ(clamped_share(10, black, 20), 1.0f) << "a black cell must be able to recover";
}

/// A vertex without a cell, too, chooses lights and directions.
TEST(CellUpdates, TakeEstimatesFromTheRegionOfTheVertex) {
  CellUpdateContext context;
  const SampleIndex index;
  PathState path;
  path.dispersed = true;  // no cell
  SurfacePoint sp = point_at({1, 1, -2});
  CellUpdate(context, index, 0, 0).arrived(sp, path);
  EXPECT_EQ(sp.region, kNoRegion);
  context.regions.tree = eight_leaves();
  CellUpdate(context, index, 0, 0).arrived(sp, path);
  EXPECT_EQ(sp.region, 3u);
}

TEST(CellUpdates, BlocksCoverTheImage) {
  EXPECT_EQ(update_blocks(25, kUpdateBlock), 5u);
  EXPECT_EQ(update_blocks(26, kUpdateBlock), 6u);
  EXPECT_EQ(update_blocks(26, 1), 26u);
}

}  // namespace
}  // namespace relume
