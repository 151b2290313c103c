// Records of camera subpaths for learned structures.
#include <gtest/gtest.h>

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

/// Recorded values estimate the same light, so connections change the noise only.
void expect_values_of_path_tracing(const Scene& scene, bool guided, const std::string& name) {
  constexpr double kStandardErrors = 5;
  RecordedFrames frames(Scene(scene), options_with(6), guided);
  const std::array<Mean, kVertices> both = frames.bidirectional(512);
  const std::array<Mean, kVertices> camera_alone = frames.unidirectional(1024);
  for (uint32_t v = 0; v < kVertices; ++v) {
    const double noise = std::sqrt(both[v].variance + camera_alone[v].variance);
    EXPECT_LT(noise, 0.06 * both[v].value) << name << ", vertex " << v << ": too noisy to say anything";
    EXPECT_NEAR(both[v].value, camera_alone[v].value, kStandardErrors * noise) << name << ", vertex " << v;
  }
}

TEST(BdptRecording, HasTheLightOfPathTracing) {
  for (const ZooLight light : {ZooLight::triangles, ZooLight::environment_map}) {
    const std::string name = kZooLightNames[static_cast<int>(light)];
    expect_values_of_path_tracing(make_zoo(light, ZooCamera::pinhole, false), false, name);
  }
}

TEST(BdptRecording, HasTheLightOfGuidedPathTracing) {
  expect_values_of_path_tracing(make_zoo(ZooLight::triangles, ZooCamera::pinhole, false), true, "guided");
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
