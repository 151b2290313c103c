#include "techniques/spatial/octree/sample_stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "core/stream_io.h"
#include "techniques/spatial/octree/path_recording.h"
#include "testing/random.h"

namespace relume {
namespace {

std::vector<uint32_t> copy(View<const uint32_t> v) { return {v.begin(), v.end()}; }

SampleStream random_stream(uint32_t pixels, uint32_t regions) {
  Backend backend(2);
  SampleStream stream;
  stream.resize(backend, pixels, 2);
  testing::Random random(3);
  for (VertexSample& s : stream.samples()) {
    // Low regions have most of the samples; three in ten records are empty.
    s.region =
        random.next() < 0.3f ? kNoRegion : static_cast<uint32_t>(sqr(random.next()) * static_cast<float>(regions));
  }
  return stream;
}

TEST(SampleStream, GroupsLikeAStableSort) {
  constexpr uint32_t kRegions = 300;
  SampleStream stream = random_stream(10007, kRegions);
  Backend backend(2);
  stream.group(backend, kRegions);
  const View<VertexSample> samples = stream.samples();
  std::vector<uint32_t> expected;
  for (uint32_t i = 0; i < samples.size; ++i) {
    if (samples[i].region < kRegions) expected.push_back(i);
  }
  std::stable_sort(expected.begin(), expected.end(),
                   [&](uint32_t a, uint32_t b) { return samples[a].region < samples[b].region; });
  const SampleGroupsView groups = stream.groups();
  EXPECT_EQ(copy(groups.order), expected);
  uint32_t next = 0;
  for (uint32_t r = 0; r < kRegions; ++r) {
    EXPECT_EQ(groups.offsets[r], next);
    next += groups.counts[r];
    for (uint32_t i = 0; i < groups.counts[r]; ++i) EXPECT_EQ(groups.sample(r, i).region, r);
  }
  EXPECT_EQ(next, groups.order.size);
}

TEST(SampleStream, DoesNotDependOnThreads) {
  std::vector<uint32_t> orders[2];
  for (const int threads : {1, 4}) {
    SampleStream stream = random_stream(5000, 50);
    Backend backend(threads);
    stream.group(backend, 50);
    orders[threads == 1 ? 0 : 1] = copy(stream.groups().order);
  }
  EXPECT_EQ(orders[0], orders[1]);
}

TEST(SampleStream, KeepsSamplesOfFirstVertices) {
  Backend backend(2);
  SampleStream stream;
  stream.resize(backend, 3, 1);
  for (VertexSample& sample : stream.samples()) sample.region = 1;
  stream.resize(backend, 3, 2);
  ASSERT_EQ(stream.samples().size, 6u);
  for (uint32_t i = 0; i < 6; ++i) EXPECT_EQ(stream.samples()[i].region, i < 3 ? 1u : kNoRegion);
  stream.resize(backend, 3, 1);
  stream.group(backend, 2);
  EXPECT_EQ(stream.groups().counts[1], 3u);
}

TEST(SampleStream, HoldsImportanceOnlyIfItIsLearned) {
  Backend backend(1);
  SampleStream stream;
  stream.resize(backend, 10, 2, true);
  ASSERT_EQ(stream.importance().size, 20u);
  stream.importance()[7] = {5, 0.25f};
  std::stringstream file;
  stream.save(file, true);
  SampleStream loaded;
  loaded.load(file, true);
  ASSERT_FALSE(file.fail());
  ASSERT_EQ(loaded.importance().size, 20u);
  EXPECT_EQ(loaded.importance()[7].value, 0.25f);
  EXPECT_EQ(loaded.importance()[8].value, 0.0f);
  stream.resize(backend, 10, 2);
  EXPECT_TRUE(stream.importance().empty());
}

TEST(SampleStream, RejectsAnotherNumberOfImportanceSamples) {
  std::stringstream file;
  write_vector(file, std::vector<VertexSample>(4));
  write_vector(file, std::vector<ImportanceSample>(3));
  SampleStream stream;
  stream.load(file, true);
  EXPECT_TRUE(file.fail());
  EXPECT_TRUE(stream.importance().empty());
}

TEST(SampleStream, OmitsRegionsOutOfRange) {
  Backend backend(1);
  SampleStream stream;
  stream.resize(backend, 3, 1);
  stream.samples()[1].region = 7;
  stream.group(backend, 7);  // region 7 is out of range
  EXPECT_EQ(stream.groups().order.size, 0u);
  stream.group(backend, 8);
  EXPECT_EQ(stream.groups().order.size, 1u);
  stream.group(backend, 0);
}

TEST(SampleStream, RoundTripsThroughAStream) {
  SampleStream stream = random_stream(100, 9);
  std::stringstream file;
  stream.save(file);
  SampleStream other;
  other.load(file);
  ASSERT_EQ(other.samples().size, stream.samples().size);
  for (uint32_t i = 0; i < 200; ++i) EXPECT_EQ(other.samples()[i].region, stream.samples()[i].region);
  std::stringstream cut(file.str().substr(0, 50));
  other.load(cut);
  EXPECT_FALSE(cut);
}

/// The members of a path that PathRecorder reads.
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
struct FakeConnection {
  LightId light;
  Rgb contribution{1};
};

class Recording : public ::testing::Test {
 protected:
  static constexpr uint32_t kNodes[1] = {0xffu};  // eight leaves over the cube from -1 to 1
  Recording() : samples_(2 * 10) {
    recording_.octree = {{kNodes, 1}, Vec3(-1), static_cast<float>(1u << kMaxOctreeDepth) / 2};
    recording_.samples = mutable_view_of(samples_);
    recording_.vertices = 2;
    recording_.pixels = 10;
    point_.frame = make_frame(Vec3(0, 0, 1));
    path_.ray.direction = glm::normalize(Vec3(0.6f, 0, 0.8f));
  }
  void place(const Vec3& now, const Vec3& before) {
    point_.position = now;
    point_.previous_position = before;
  }

  std::vector<VertexSample> samples_;
  PathRecording recording_;
  SurfacePoint point_{};
  FakePath path_;
};

TEST_F(Recording, ReadsAtTheOldAndWritesAtTheNewPosition) {
  PathRecorder recorder = recording_.begin(3);
  place(Vec3(0.5f), Vec3(-0.5f, 0.5f, 0.5f));
  recorder.arrived(point_, path_);
  EXPECT_EQ(point_.region, 6u);
  recorder.finished(path_);
  EXPECT_EQ(samples_[3].region, 7u);
  EXPECT_EQ(samples_[3].light, kNoLight);
  EXPECT_EQ(samples_[3].value, 0.0f);
  EXPECT_EQ(samples_[13].region, kNoRegion);  // the path has no second vertex
}

TEST_F(Recording, KeepsLightsAndWhetherTheyWereVisible) {
  PathRecorder recorder = recording_.begin(0);
  place(Vec3(0.5f), Vec3(0.5f));
  recorder.arrived(point_, path_);
  recorder.connected(point_, path_, FakeConnection{42}, true);
  path_.bounce = 1;
  recorder.arrived(point_, path_);
  recorder.connected(point_, path_, FakeConnection{43}, false);
  path_.bounce = 2;
  recorder.arrived(point_, path_);
  recorder.connected(point_, path_, FakeConnection{44}, true);  // beyond the recorded vertices
  recorder.finished(path_);
  EXPECT_EQ(samples_[0].light, 42u | kVisibleLight);
  EXPECT_EQ(samples_[10].light, 43u);
}

TEST_F(Recording, ValueExcludesTheBsdfAndSampledLights) {
  PathRecorder recorder = recording_.begin(0);
  place(Vec3(0.5f), Vec3(0.5f));
  recorder.arrived(point_, path_);
  path_.radiance = Rgb(5);             // direct light at the first vertex
  path_.throughput = Rgb(0.5f, 0, 1);  // no green, so the incident green is unknown
  path_.bounce = 1;
  recorder.scattered(point_, BsdfSample{}, path_);
  path_.radiance += path_.throughput * Rgb(100);  // the ray hits a lamp
  recorder.emitted(path_, true);
  recorder.arrived(point_, path_);
  path_.radiance += path_.throughput * Rgb(2, 9, 3);
  recorder.finished(path_);
  const float cosine = shading_cosine(point_, path_.ray.direction);
  EXPECT_NEAR(samples_[0].value, luminance(Rgb(2, 0, 3)) * cosine / 0.5f, 1e-3f);
  const Vec2 direction = unpack_square(samples_[0].direction);
  EXPECT_NEAR(glm::dot(direction_from_square(direction), path_.ray.direction), 1.0f, 1e-6f);

  // The emission of a lamp that light sampling does not cover counts.
  PathRecorder other = recording_.begin(1);
  FakePath path = path_;
  path.bounce = 0;
  path.radiance = Rgb(0);
  path.throughput = Rgb(1);
  other.arrived(point_, path);
  path.bounce = 1;
  other.scattered(point_, BsdfSample{}, path);
  path.radiance += Rgb(100);
  other.emitted(path, false);
  other.finished(path);
  EXPECT_NEAR(samples_[1].value, 100 * cosine / 0.5f, 1e-3f);
}

TEST_F(Recording, ValueHasTheWeightOfTheWavelength) {
  PathRecorder recorder = recording_.begin(0);
  place(Vec3(0.5f), Vec3(0.5f));
  recorder.arrived(point_, path_);
  path_.wavelength_nm = 611;
  path_.dispersed = true;
  const Rgb weight = wavelength_weight(path_.wavelength_nm);
  path_.throughput = Rgb(0.5f) * weight;
  path_.bounce = 1;
  recorder.scattered(point_, BsdfSample{}, path_);
  path_.radiance += path_.throughput * Rgb(2, 4, 3);
  recorder.finished(path_);
  const float cosine = shading_cosine(point_, path_.ray.direction);
  EXPECT_NEAR(samples_[0].value, luminance(weight * Rgb(2, 4, 3)) * cosine / 0.5f, 1e-3f);
}

TEST_F(Recording, DeltaBouncesLeaveNoDirection) {
  PathRecorder recorder = recording_.begin(0);
  place(Vec3(0.5f), Vec3(0.5f));
  recorder.arrived(point_, path_);
  path_.bounce = 1;
  path_.delta = true;
  recorder.scattered(point_, BsdfSample{}, path_);
  path_.radiance = Rgb(7);
  recorder.finished(path_);
  EXPECT_EQ(samples_[0].region, 7u);
  EXPECT_EQ(samples_[0].value, 0.0f);
}

TEST_F(Recording, SurvivorsOfRouletteTrainWithoutItsFactor) {
  place(Vec3(0.5f), Vec3(0.5f));
  for (const uint32_t pixel : {0u, 1u}) {
    const float survival = pixel == 0 ? 1.0f : 0.25f;
    PathRecorder recorder = recording_.begin(pixel);
    FakePath path = path_;
    recorder.arrived(point_, path);
    path.throughput = Rgb(0.5f / survival);
    path.bounce = 1;
    recorder.scattered(point_, BsdfSample{}, path);
    path.radiance += path.throughput * Rgb(2);
    recorder.finished(path);
  }
  EXPECT_GT(samples_[0].value, 0.0f);
  EXPECT_FLOAT_EQ(samples_[1].value, samples_[0].value);

  PathRecorder ended = recording_.begin(2);
  FakePath path = path_;
  ended.arrived(point_, path);
  path.radiance = Rgb(3);  // direct light, before roulette
  ended.finished(path);
  EXPECT_EQ(samples_[2].value, 0.0f);
}

TEST_F(Recording, ValuesHaveTheFactorOfResampling) {
  place(Vec3(0.5f), Vec3(0.5f));
  for (const uint32_t pixel : {0u, 1u}) {
    BsdfSample s;
    s.resampling = pixel == 0 ? 1.0f : 3.0f;
    s.weight = Rgb(0.37f * s.resampling);
    s.bsdf_pdf_w = 2;
    PathRecorder recorder = recording_.begin(pixel);
    FakePath path = path_;
    recorder.arrived(point_, path);
    path.throughput = s.weight;
    path.bounce = 1;
    recorder.scattered(point_, s, path);
    path.radiance += path.throughput * Rgb(2);
    recorder.finished(path);
  }
  EXPECT_FLOAT_EQ(samples_[1].value, 3 * samples_[0].value);
  EXPECT_EQ(samples_[1].bsdf, samples_[0].bsdf);
  EXPECT_NE(samples_[0].bsdf, 0u);
}

TEST_F(Recording, SkippedPixelsDiscardTheLastFrame) {
  samples_[4].region = 1;
  samples_[14].region = 1;
  recording_.skip(4);
  EXPECT_EQ(samples_[4].region, kNoRegion);
  EXPECT_EQ(samples_[14].region, kNoRegion);
}

}  // namespace
}  // namespace relume
