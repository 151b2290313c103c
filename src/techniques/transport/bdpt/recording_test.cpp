// Records of camera subpaths for learned structures.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "techniques/transport/bdpt/testing/bdpt_frame.h"
#include "techniques/transport/bdpt/testing/random_guides.h"
#include "techniques/transport/bdpt/testing/zoo.h"
#include "techniques/transport/path/recording_output.h"

namespace relume::testing {
namespace {

constexpr uint32_t kVertices = 3;

/// Mean over frames, with its variance.
struct Mean {
  double value = 0;
  double variance = 0;
};

/// Traces frames of a scene that record their paths, by bidirectional and by unidirectional path tracing.
class RecordedFrames {
 public:
  RecordedFrames(Scene scene, const BdptOptions& options, bool guided)
      : frame_(std::move(scene), options),
        guides_(frame_.backend, frame_.compiled.view()),
        samples_(frame_.hits.size() * kVertices),
        context_{frame_.context()} {
    const DirectionSampler from_bsdf = context_.path.directions;
    guides_.guide(context_);
    if (!guided) context_.path.directions = from_bsdf;
    context_.recording.samples = mutable_view_of(samples_);
    context_.recording.vertices = kVertices;
    context_.recording.pixels = static_cast<uint32_t>(frame_.hits.size());
  }

  /// Mean value of a record, by vertex.
  std::array<Mean, kVertices> bidirectional(uint32_t frames) {
    return means(frames, [&](uint32_t i) { frame_.run_in(context_, 3, i); });
  }
  std::array<Mean, kVertices> unidirectional(uint32_t frames) {
    return means(frames, [&](uint32_t i) { trace_paths(i); });
  }

 private:
  void trace_paths(uint32_t i) {
    const SampleIndex index = frame_.find_hits(4, i);
    const PathKernel<RadianceOutput, RecordingOutput> kernel{
        .context = context_.path,
        .index = index,
        .hits = view_of(frame_.hits),
        .allocation = {},
        .rays = mutable_view_of(frame_.rays),
        .width = frame_.width(),
        .outputs = path_outputs(RadianceOutput{mutable_view_of(frame_.radiance)}, RecordingOutput{context_.recording})};
    launch(frame_.backend, "trace", kernel, frame_.width(), frame_.height());
  }

  template <typename Trace>
  std::array<Mean, kVertices> means(uint32_t frames, const Trace& trace) {
    std::array<Mean, kVertices> result;
    for (uint32_t i = 0; i < frames; ++i) {
      trace(i);
      for (uint32_t v = 0; v < kVertices; ++v) {
        const double mean = mean_of_records(v);
        result[v].value += mean;
        result[v].variance += mean * mean;
      }
    }
    const double n = frames;
    for (Mean& m : result) {
      m.value /= n;
      m.variance = (m.variance / n - m.value * m.value) / n;
    }
    return result;
  }

  /// Over all pixels, also those whose path has fewer vertices.
  double mean_of_records(uint32_t v) const {
    const size_t pixels = frame_.hits.size();
    double sum = 0;
    for (size_t p = 0; p < pixels; ++p) sum += static_cast<double>(samples_[v * pixels + p].value);
    return sum / static_cast<double>(pixels);
  }

  BdptFrame frame_;
  RandomGuides guides_;
  std::vector<VertexSample> samples_;
  LearningContext context_;
};

/// Records do not compensate for roulette.
BdptOptions options_with(uint32_t max_bounces) {
  return {.max_bounces = max_bounces, .russian_roulette = false, .connection_roulette = 0.25f};
}

/// In a closed sphere of radiance 1, the light of paths with at least two segments has the radiance Σ ρ^k. The last
/// vertex of the longest path has max_bounces scatterings before it.
TEST(BdptRecording, HasTheLightOfAClosedFurnace) {
  constexpr float kAlbedo = 0.6f;
  constexpr uint32_t kBounces = 4;
  RecordedFrames frames(make_closed_sphere(kAlbedo), options_with(kBounces), false);
  const std::array<Mean, kVertices> means = frames.bidirectional(64);
  for (uint32_t v = 0; v < kVertices; ++v) {
    double expected = 0;
    for (uint32_t k = 1; k + v < kBounces; ++k) expected += std::pow(static_cast<double>(kAlbedo), k);
    expected *= static_cast<double>(kPi);  // cos θ / pdf_w
    EXPECT_LT(std::sqrt(means[v].variance), 0.01 * expected) << "vertex " << v;
    EXPECT_NEAR(means[v].value, expected, 0.02 * expected) << "vertex " << v;
  }
}

/// Recorded values of the first `vertices` vertices estimate the same light, so connections change the noise only.
void expect_values_of_path_tracing(ZooLight light, bool guided, uint32_t count, uint32_t vertices) {
  constexpr double kStandardErrors = 5;
  const std::string name = kZooLightNames[static_cast<int>(light)];
  RecordedFrames frames(make_zoo(light, ZooCamera::pinhole, false), options_with(6), guided);
  const std::array<Mean, kVertices> both = frames.bidirectional(count);
  const std::array<Mean, kVertices> camera_alone = frames.unidirectional(2 * count);
  for (uint32_t v = 0; v < vertices; ++v) {
    const double noise = std::sqrt(both[v].variance + camera_alone[v].variance);
    EXPECT_LT(noise, 0.08 * both[v].value) << name << ", vertex " << v << ": too noisy to say anything";
    EXPECT_NEAR(both[v].value, camera_alone[v].value, kStandardErrors * noise) << name << ", vertex " << v;
  }
}

/// Path tracing finds the light of later vertices by few bright samples.
TEST(BdptRecording, HasTheLightOfPathTracing) { expect_values_of_path_tracing(ZooLight::triangles, false, 1024, 1); }

TEST(BdptRecording, HasTheLightOfPathTracingUnderAnEnvironment) {
  expect_values_of_path_tracing(ZooLight::environment_map, false, 1024, kVertices);
}

/// Random quadtrees make the light of later vertices too noisy.
TEST(BdptRecording, HasTheLightOfGuidedPathTracing) {
  expect_values_of_path_tracing(ZooLight::triangles, true, 2048, 2);
}

TEST(BdptRecording, TestsAllConnectionsToLightsOfRecordedVertices) {
  BdptOptions options = options_with(6);
  options.connection_roulette = 1;
  BdptFrame frame(make_zoo(ZooLight::triangles, ZooCamera::pinhole, false), options);
  std::vector<VertexSample> samples(frame.hits.size() * kVertices);
  LearningContext c{frame.context()};
  c.recording.samples = mutable_view_of(samples);
  c.recording.vertices = kVertices;
  c.recording.pixels = static_cast<uint32_t>(frame.hits.size());
  const auto tried = [&](uint32_t vertex) {
    size_t count = 0;
    for (size_t p = 0; p < frame.hits.size(); ++p) {
      const VertexSample& sample = samples[vertex * frame.hits.size() + p];
      if (sample.light != kNoLight) ++count;
    }
    return count;
  };
  std::array<size_t, kVertices> with_roulette = {};
  std::array<size_t, kVertices> without = {};
  for (uint32_t i = 0; i < 8; ++i) {
    c.connection_roulette = 1;
    frame.run_in(c, 1, i);
    for (uint32_t v = 0; v < kVertices; ++v) with_roulette[v] += tried(v);
    c.connection_roulette = 0;
    frame.run_in(c, 1, i);
    for (uint32_t v = 0; v < kVertices; ++v) without[v] += tried(v);
  }
  EXPECT_EQ(with_roulette, without);
  EXPECT_GT(without[kVertices - 1], 20u);
}

/// A frame whose camera subpaths record importance.
struct ImportanceFrame {
  ImportanceFrame(Scene scene, const BdptOptions& options)
      : frame(std::move(scene), options),
        guides(frame.backend, frame.compiled.view()),
        samples(frame.hits.size() * kVertices),
        importance(samples.size()),
        context{frame.context()} {
    const DirectionSampler from_bsdf = context.path.directions;
    guides.guide(context);
    context.path.directions = from_bsdf;
    context.recording.samples = mutable_view_of(samples);
    context.recording.vertices = kVertices;
    context.recording.pixels = static_cast<uint32_t>(frame.hits.size());
    context.recording.importance = mutable_view_of(importance);
  }

  BdptFrame frame;
  RandomGuides guides;  ///< for their octree
  std::vector<VertexSample> samples;
  std::vector<ImportanceSample> importance;
  LearningContext context;
};

Vec3 unpacked(uint32_t direction) { return direction_from_square(unpack_square(direction)); }

/// In a closed sphere, all subpaths have all vertices. Each scattering multiplies the throughput by the albedo.
void expect_importance_of_a_furnace(bool light_only) {
  constexpr float kAlbedo = 0.6f;
  BdptOptions options = options_with(6);
  options.light_only = light_only;
  ImportanceFrame f(make_closed_sphere(kAlbedo), options);
  f.frame.run_in(f.context, 5, 0);
  const size_t pixels = f.frame.hits.size();
  for (size_t p = 0; p < pixels; ++p) {
    EXPECT_EQ(f.importance[p].value, 0.0f);  // connections to the camera find that of the first vertex
    float expected = 1;
    for (size_t v = 1; v < kVertices; ++v) {
      expected *= kAlbedo;
      const ImportanceSample& s = f.importance[v * pixels + p];
      EXPECT_NEAR(s.value, expected, 1e-4f);
      const Vec3 onwards = unpacked(f.samples[(v - 1) * pixels + p].direction);
      EXPECT_GT(glm::dot(unpacked(s.direction), -onwards), 0.999f) << v;
    }
  }
}

TEST(BdptRecording, HasTheImportanceOfAClosedFurnace) { expect_importance_of_a_furnace(false); }

TEST(BdptRecording, LightTracingHasTheSameImportance) { expect_importance_of_a_furnace(true); }

TEST(BdptRecording, LightTracingTakesNoLightFromCameraSubpaths) {
  BdptOptions options{.light_only = true};
  ImportanceFrame f(make_zoo(ZooLight::triangles, ZooCamera::pinhole), options);
  f.frame.run_in(static_cast<const BdptContext&>(f.context), 5, 0);
  const std::vector<Rgb> expected = f.frame.radiance;
  f.frame.run_in(f.context, 5, 0);
  EXPECT_EQ(f.frame.radiance, expected);
  EXPECT_TRUE(
      std::any_of(f.importance.begin(), f.importance.end(), [](const ImportanceSample& s) { return s.value > 0.0f; }));
}

/// A camera subpath of two vertices. A cache divides its throughput by `unit` at the second, and may end it there.
class SubpathWithACache {
 public:
  explicit SubpathWithACache(const Rgb& unit) : unit_(unit), samples_(2) {
    recording_.octree = {{kNodes, 1}, Vec3(-1), static_cast<float>(1u << kMaxOctreeDepth) / 2};
    recording_.samples = mutable_view_of(samples_);
    recording_.vertices = 2;
    recording_.pixels = 1;
    point_.frame = make_frame(Vec3(0, 0, 1));
    point_.position = point_.previous_position = Vec3(0.5f);
    path_.ray.direction = glm::normalize(Vec3(0.6f, 0, 0.8f));
    path_.pdf_w = 0.5f;
    path_.delta = false;
  }

  /// Records the subpath. `survival`: probability with which the cache lets it continue; 0: it ends.
  std::vector<VertexSample> record(float survival) {
    SubpathRecorder recorder(recording_, chains_, 0);
    recorder.arrived(point_, path_);
    leave(recorder, Rgb(0.5f, 0.25f, 0.75f));
    recorder.add(Rgb(1, 2, 3), {0, 0});
    recorder.arrived(point_, path_);
    recorder.rebased(Rgb(0), unit_);
    path_.throughput /= unit_;
    if (survival > 0.0f) {
      if (survival < 1.0f) recorder.survived(survival);
      recorder.add(Rgb(3, 2, 1) / unit_, {0, 0});
      leave(recorder, Rgb(0.5f));
      recorder.add(Rgb(4, 1, 2) / unit_, {0, 0});
    } else {
      recorder.culled();
    }
    recorder.finished(path_);
    return samples_;
  }

 private:
  static constexpr uint32_t kNodes[1] = {0xffu};  // eight leaves over the cube from -1 to 1

  void leave(SubpathRecorder& recorder, const Rgb& weight) {
    path_.throughput *= weight;
    ++path_.bounce;
    recorder.scattered(context_, point_, BsdfSample{}, path_);
    recorder.left(0.8f, 0.5f, 0.0f);
    recorder.moved(0.8f, 1.0f);
    recorder.weigh({});
  }

  Rgb unit_;
  std::vector<VertexSample> samples_;
  PathRecording recording_;
  SubpathChains chains_;
  BdptContext context_;
  SurfacePoint point_{};
  PathState path_;
};

TEST(BdptRecording, DoesNotDependOnTheUnitsOfACache) {
  const std::vector<VertexSample> image = SubpathWithACache(Rgb(1)).record(1);
  const std::vector<VertexSample> cells = SubpathWithACache(Rgb(0.25f, 2, 0.5f)).record(1);
  for (size_t v = 0; v < 2; ++v) {
    EXPECT_GT(image[v].value, 1.0f);
    EXPECT_NEAR(cells[v].value, image[v].value, 1e-4f * image[v].value);
    EXPECT_EQ(cells[v].weight, 1.0f);
  }
}

TEST(BdptRecording, SubpathsThatContinueStandForThoseThatEnd) {
  for (const VertexSample& sample : SubpathWithACache(Rgb(0.5f)).record(0.25f)) EXPECT_EQ(sample.weight, 4.0f);
  for (const VertexSample& sample : SubpathWithACache(Rgb(0.5f)).record(0)) {
    EXPECT_NE(sample.region, kNoRegion);
    EXPECT_EQ(sample.weight, 0.0f);
  }
}

/// No light subpath that continues to a mirror in direct view can be connected to the camera.
TEST(BdptRecording, LeavesOutImportanceThatOnlySpecularScatteringPassedOn) {
  constexpr uint32_t kNodes[1] = {0xffu};  // eight leaves over the cube from -1 to 1
  std::vector<VertexSample> samples(3);
  std::vector<ImportanceSample> importance(3);
  PathRecording recording;
  recording.octree = recording.lookup.tree = {{kNodes, 1}, Vec3(-1), static_cast<float>(1u << kMaxOctreeDepth) / 2};
  recording.samples = mutable_view_of(samples);
  recording.vertices = 3;
  recording.pixels = 1;
  recording.importance = mutable_view_of(importance);
  SurfacePoint sp{};
  sp.frame = make_frame(Vec3(0, 0, 1));
  sp.wo = glm::normalize(Vec3(0.3f, 0.1f, 0.8f));
  PathState path;
  path.ray.direction = glm::normalize(Vec3(0.6f, 0, 0.8f));
  path.pdf_w = 0.5f;
  const SubpathChains chains{};
  SubpathRecorder recorder(recording, chains, 0);
  for (const bool delta : {true, false, true}) {
    recorder.arrived(sp, path);
    path.throughput *= Rgb(0.5f);
    path.delta = delta;
    ++path.bounce;
    recorder.scattered(BdptContext{}, sp, BsdfSample{}, path);
  }
  recorder.finished(path);
  EXPECT_EQ(importance[0].value, 0.0f);
  EXPECT_EQ(importance[1].value, 0.0f);
  EXPECT_FLOAT_EQ(importance[2].value, 0.25f);
  EXPECT_GT(glm::dot(unpacked(importance[2].direction), sp.wo), 0.9999f);
}

TEST(BdptRecording, UnallocatedPixelsHaveNoRecords) {
  BdptFrame frame(make_closed_sphere(0.6f), options_with(6));
  std::vector<VertexSample> samples(frame.hits.size() * kVertices);
  for (VertexSample& sample : samples) sample.value = 1;  // of an earlier frame
  LearningContext c{frame.context()};
  c.recording.samples = mutable_view_of(samples);
  c.recording.vertices = kVertices;
  c.recording.pixels = static_cast<uint32_t>(frame.hits.size());
  frame.allocation.assign(frame.hits.size(), 0);
  frame.allocation[37] = 1;
  frame.run_in(c, 1, 0);
  for (size_t i = 0; i < samples.size(); ++i) {
    if (i % frame.hits.size() == 37) {
      EXPECT_GT(samples[i].value, 0.0f);
    } else {
      EXPECT_EQ(samples[i].value, 0.0f);
    }
  }
}

}  // namespace
}  // namespace relume::testing
