#include "techniques/spatial/octree/cached_path_recorder.h"

#include <gtest/gtest.h>

#include <vector>

namespace relume {
namespace {

/// The members of a path that recorders read.
struct FakePath {
  Ray ray;
  Rgb throughput{1};
  Rgb radiance{0};
  float pdf_w = 0.5f;
  float wavelength_nm = kNoWavelength;
  bool dispersed = false;
  bool delta = false;
  uint32_t bounce = 0;
};

/// One path by PathRecorder, and the same path with a cache by CachedPathRecorder.
class CachedRecording : public ::testing::Test {
 protected:
  static constexpr uint32_t kNodes[1] = {0xffu};  // eight leaves over the cube from -1 to 1

  CachedRecording() : samples_(3) {
    recording_.octree = {{kNodes, 1}, Vec3(-1), static_cast<float>(1u << kMaxOctreeDepth) / 2};
    recording_.samples = mutable_view_of(samples_);
    recording_.vertices = 3;
    recording_.pixels = 1;
    recorder_.recording = &recording_;
    recorder_.pixel = 0;
    point_.frame = make_frame(Vec3(0, 0, 1));
    point_.position = point_.previous_position = Vec3(0.5f);
    path_.ray.direction = glm::normalize(Vec3(0.6f, 0, 0.8f));
  }

  void arrive() { recorder_.arrived(point_, path_); }
  /// Leaves the vertex; `weight`: factor of the throughput.
  void leave(const Rgb& weight, bool delta = false) {
    path_.throughput *= weight;
    path_.delta = delta;
    ++path_.bounce;
    recorder_.scattered(point_, BsdfSample{}, path_);
  }
  /// Adds light to the path.
  void find(const Rgb& light) { path_.radiance += path_.throughput * light; }
  /// Sets the unit of the path as a cache does.
  void rebase(const Rgb& throughput, const Rgb& unit) {
    recorder_.rebased(path_.radiance, unit);
    path_.radiance = Rgb(0);
    path_.throughput = throughput;
  }
  /// Value of a vertex whose direction met `light`.
  float value(const Rgb& light) const { return luminance(light) * shading_cosine(point_, path_.ray.direction) / 0.5f; }

  std::vector<VertexSample> samples_;
  PathRecording recording_;
  CachedPathRecorder recorder_;
  SurfacePoint point_{};
  FakePath path_;
};

TEST_F(CachedRecording, UnitsDoNotChangeValues) {
  arrive();
  path_.radiance = Rgb(5);
  leave(Rgb(0.5f, 0.25f, 0.125f));
  find(Rgb(3));
  const Rgb image = path_.throughput;
  arrive();
  rebase(Rgb(2, 4, 8), image * Rgb(0.5f, 0.25f, 0.125f));  // throughput 1 / albedo, unit throughput · albedo
  find(Rgb(0.5f));                                         // reflected light 0.5
  leave(Rgb(0.75f));
  find(Rgb(1, 2, 3));
  arrive();
  leave(Rgb(0.5f));
  find(Rgb(7));
  recorder_.finished(path_);
  const Rgb third = 0.5f * Rgb(7);
  const Rgb second = 0.75f * (Rgb(1, 2, 3) + third);
  EXPECT_NEAR(samples_[0].value, value(Rgb(3) + Rgb(0.5f) + second), 1e-4f);
  EXPECT_NEAR(samples_[1].value, value(Rgb(1, 2, 3) + third), 1e-4f);
  EXPECT_NEAR(samples_[2].value, value(Rgb(7)), 1e-4f);
  for (const VertexSample& sample : samples_) EXPECT_EQ(sample.weight, 1.0f);
}

TEST_F(CachedRecording, BlackChannelsOfTheImageAreUnknown) {
  arrive();
  rebase(Rgb(1), Rgb(0.5f, 0, 0.5f));  // no green albedo, but the cell has green light
  leave(Rgb(0.5f));
  find(Rgb(2, 9, 3));
  recorder_.finished(path_);
  EXPECT_NEAR(samples_[0].value, value(Rgb(2, 0, 3)), 1e-4f);
}

TEST_F(CachedRecording, CellsReplaceTheRestOfThePath) {
  arrive();
  leave(Rgb(0.5f));
  find(Rgb(4));
  const Rgb image = path_.throughput;
  arrive();
  rebase(Rgb(1), image);
  recorder_.ended_in_cell(image * Rgb(3));
  find(Rgb(100));  // counts for neither
  leave(Rgb(0.5f));
  find(Rgb(6));
  arrive();
  rebase(Rgb(1), 0.5f * image);
  recorder_.ended_in_cell(0.5f * image * Rgb(8));
  find(Rgb(100));
  leave(Rgb(1));
  find(Rgb(9));
  recorder_.finished(path_);
  EXPECT_NEAR(samples_[0].value, value(Rgb(4 + 3)), 1e-4f);
  EXPECT_NEAR(samples_[1].value, value(Rgb(6 + 8)), 1e-4f);
  EXPECT_NEAR(samples_[2].value, value(Rgb(9)), 1e-4f);
}

TEST_F(CachedRecording, LightOfDeltaLobesAddsToTheCell) {
  arrive();
  leave(Rgb(0.5f));
  const Rgb image = path_.throughput;
  arrive();
  rebase(Rgb(1), image);
  recorder_.ended_in_cell(image * Rgb(3));
  find(Rgb(100));  // next event estimation, which the cell contains
  leave(Rgb(0.25f), true);
  rebase(Rgb(0.25f), image);
  find(Rgb(8));
  recorder_.finished(path_);
  EXPECT_NEAR(samples_[0].value, value(Rgb(3 + 0.25f * 8)), 1e-4f);
  EXPECT_EQ(samples_[1].value, 0.0f);  // a delta lobe

  // A later cell leaves the light of an earlier one as it is.
  path_ = FakePath{.ray = path_.ray};
  recorder_ = CachedPathRecorder{};
  recorder_.recording = &recording_;
  recorder_.pixel = 0;
  arrive();
  leave(Rgb(0.5f));
  arrive();
  rebase(Rgb(1), image);
  recorder_.ended_in_cell(image * Rgb(3));
  leave(Rgb(0.5f));
  arrive();
  rebase(Rgb(1), 0.5f * image);
  recorder_.ended_in_cell(0.5f * image * Rgb(2));
  leave(Rgb(0.25f), true);
  rebase(Rgb(0.25f), 0.5f * image);
  find(Rgb(8));
  recorder_.finished(path_);
  EXPECT_NEAR(samples_[0].value, value(Rgb(3)), 1e-4f);
  EXPECT_NEAR(samples_[1].value, value(Rgb(2 + 0.25f * 8)), 1e-4f);
}

TEST_F(CachedRecording, LaterDeltaLobesAddNothingToTheCell) {
  arrive();
  leave(Rgb(0.5f));
  const Rgb image = path_.throughput;
  arrive();
  rebase(Rgb(1), image);
  recorder_.ended_in_cell(image * Rgb(3));
  leave(Rgb(0.5f));
  arrive();  // a mirror, which has no cell
  leave(Rgb(0.5f), true);
  find(Rgb(8));
  recorder_.finished(path_);
  EXPECT_NEAR(samples_[0].value, value(Rgb(3)), 1e-4f);
  EXPECT_NEAR(samples_[1].value, value(Rgb(0.5f * 8)), 1e-4f);
}

TEST_F(CachedRecording, SurvivorsHaveTheInverseProbability) {
  arrive();
  leave(Rgb(1));
  arrive();
  recorder_.survived(0.5f);
  leave(Rgb(1));
  arrive();
  recorder_.survived(0.125f);  // from the camera on
  recorder_.finished(path_);
  EXPECT_EQ(samples_[0].weight, 1.0f);
  EXPECT_EQ(samples_[1].weight, 2.0f);
  EXPECT_EQ(samples_[2].weight, 8.0f);
}

TEST_F(CachedRecording, CulledPathsShowTheirRegionAndDoNotTrain) {
  arrive();
  leave(Rgb(0.5f));
  const Rgb image = path_.throughput;
  arrive();
  rebase(Rgb(1), image);
  recorder_.ended_in_cell(image * Rgb(3));
  recorder_.culled();
  recorder_.finished(path_);
  EXPECT_NEAR(samples_[0].value, value(Rgb(3)), 1e-4f);
  EXPECT_EQ(samples_[0].weight, 1.0f);
  EXPECT_EQ(samples_[1].region, 7u);
  EXPECT_EQ(samples_[1].weight, 0.0f);
  EXPECT_EQ(samples_[2].region, kNoRegion);
  const SampleRegions regions{view_of(samples_)};
  EXPECT_EQ(regions(0), 7u);
  EXPECT_EQ(regions(1), kNoRegion);
  EXPECT_EQ(regions(2), kNoRegion);
}

TEST_F(CachedRecording, VerticesWithoutARecordPassOnTheirCell) {
  recording_.vertices = 1;
  arrive();
  leave(Rgb(0.5f));
  arrive();
  leave(Rgb(0.5f));
  const Rgb image = path_.throughput;
  arrive();
  rebase(Rgb(1), image);
  recorder_.ended_in_cell(image * Rgb(4));
  recorder_.culled();
  recorder_.finished(path_);
  EXPECT_NEAR(samples_[0].value, value(Rgb(0.5f * 4)), 1e-4f);
  EXPECT_EQ(samples_[0].weight, 1.0f);
}

}  // namespace
}  // namespace relume
