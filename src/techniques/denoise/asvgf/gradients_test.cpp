#include "techniques/denoise/asvgf/gradients.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 54;
constexpr uint32_t kHeight = 47;  // the last row of strata has two rows of pixels
constexpr uint32_t kPixels = kWidth * kHeight;
constexpr uint32_t kColumns = strata(kWidth);
constexpr uint32_t kRows = strata(kHeight);

PathContext context_of(const CompiledScene& scene) {
  PathContext context;
  context.scene = scene.view();
  context.selector.kind = LightSelectorKind::uniform;
  context.selector.uniform = make_uniform_lights(scene.view().lights);
  return context;
}

/// A frame of one sample per pixel.
struct TracedFrame {
  TracedFrame(const CompiledScene& scene, const SampleIndex& numbers) : index(numbers), context(context_of(scene)) {
    const PrimaryHitsKernel primary{scene.view(), index, mutable_view_of(hits), {}, kWidth};
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x) {
        primary(x, y);
        Sampler sampler = index.sampler(x, y);
        radiance[y * kWidth + x] = trace_path(context, x, y, sampler, hits[y * kWidth + x]).radiance;
      }
    }
  }

  std::vector<GradientSample> record() const {
    std::vector<GradientSample> samples(size_t{kColumns} * kRows);
    RecordSamplesKernel kernel;
    kernel.context = context;
    kernel.index = index;
    kernel.hits = view_of(hits);
    kernel.radiance = view_of(radiance);
    kernel.allocation = view_of(allocation);
    kernel.samples = mutable_view_of(samples);
    kernel.columns = kColumns;
    kernel.width = kWidth;
    kernel.height = kHeight;
    for (uint32_t y = 0; y < kRows; ++y) {
      for (uint32_t x = 0; x < kColumns; ++x) kernel(x, y);
    }
    return samples;
  }

  SampleIndex index;
  PathContext context;
  std::vector<uint32_t> allocation;
  std::vector<Hit> hits = std::vector<Hit>(kPixels);
  std::vector<Rgb> radiance = std::vector<Rgb>(kPixels);
};

/// Gradients of a frame's samples in a scene, from the view of its previous camera.
std::vector<Vec2> trace(const CompiledScene& scene, const TracedFrame& frame,
                        const std::vector<GradientSample>& samples) {
  std::vector<uint64_t> votes(samples.size(), kNoVote);
  const ProjectSamplesKernel project{scene.view(), view_of(samples), mutable_view_of(votes), kColumns, kWidth, kHeight};
  std::vector<Vec2> gradients(samples.size(), Vec2(-7));
  std::vector<uint32_t> rays(kPixels);
  TraceGradientsKernel kernel;
  kernel.context = context_of(scene);
  kernel.context.scene.camera = scene.view().previous_camera;
  kernel.camera = scene.view().camera;
  kernel.index = frame.index;
  kernel.index.camera_runs = frame.index.runs_through();
  kernel.index.taken = {};
  kernel.samples = view_of(samples);
  kernel.votes = view_of(votes);
  kernel.gradients = mutable_view_of(gradients);
  kernel.rays = mutable_view_of(rays);
  kernel.same_view = true;
  kernel.columns = kColumns;
  kernel.width = kWidth;
  kernel.height = kHeight;
  for (uint32_t y = 0; y < kRows; ++y) {
    for (uint32_t x = 0; x < kColumns; ++x) project(x, y);
  }
  for (uint32_t y = 0; y < kRows; ++y) {
    for (uint32_t x = 0; x < kColumns; ++x) kernel(x, y);
  }
  return gradients;
}

CompileOptions options() { return {.camera = {}, .width = kWidth, .height = kHeight}; }

Scene named(const char* name) { return find_builtin_scene(name)->build(); }

/// Moves the camera to its right between two frames, in metres.
void shift_camera(CompiledScene& scene, float distance) {
  CameraPose camera = scene.camera();
  camera.to_world[3] += distance * camera.to_world[0];
  scene.end_frame();
  scene.set_camera(camera);
}

/// Strata with light in either frame.
size_t lit(const std::vector<Vec2>& gradients) {
  return static_cast<size_t>(std::count_if(gradients.begin(), gradients.end(), [](const Vec2& g) { return g.y > 0; }));
}

TEST(Gradients, AreZeroToTheBitWhereNothingChanges) {
  for (const char* name : {"cornell", "cornell-glass", "cornell-spheres"}) {
    for (const float distance : {0.0f, 0.21f}) {
      SCOPED_TRACE(::testing::Message() << name << ", camera moved by " << distance);
      CompiledScene scene(named(name), options());
      const TracedFrame frame(scene, {.seed = 7, .sample = 3});
      const std::vector<GradientSample> samples = frame.record();
      shift_camera(scene, distance);
      const std::vector<Vec2> gradients = trace(scene, frame, samples);
      EXPECT_GT(lit(gradients), gradients.size() / 2);
      for (size_t i = 0; i < gradients.size(); ++i) ASSERT_EQ(gradients[i].x, 0.0f) << i;
    }
  }
}

TEST(Gradients, RepeatTheNumbersOfEverySequence) {
  std::vector<uint32_t> taken(kPixels);
  for (uint32_t i = 0; i < kPixels; ++i) taken[i] = i % 5;
  const SampleIndex indices[] = {
      {.seed = 7, .sequence = 9, .sample = 3, .frame = 9},
      {.seed = 7, .sample = 3, .age = 2, .taken = view_of(taken), .width = kWidth},
      {.seed = 7, .sequence = 5, .sample = 3, .age = 11, .camera_runs = true},
  };
  for (const SampleIndex& index : indices) {
    CompiledScene scene(named("cornell"), options());
    const TracedFrame frame(scene, index);
    const std::vector<GradientSample> samples = frame.record();
    shift_camera(scene, 0.1f);
    const std::vector<Vec2> gradients = trace(scene, frame, samples);
    EXPECT_GT(lit(gradients), gradients.size() / 2);
    for (size_t i = 0; i < gradients.size(); ++i) ASSERT_EQ(gradients[i].x, 0.0f) << i;
  }
}

TEST(Gradients, LampsThatGoOutTakeAllLight) {
  Scene source = named("cornell");
  CompiledScene scene(source, options());
  const TracedFrame frame(scene, {.seed = 7, .sample = 3});
  for (Material& material : source.materials) material.emission = Rgb(0);
  source.environment = Environment{};
  const CompiledScene dark(std::move(source), options());
  ASSERT_FALSE(dark.in_studio());
  const std::vector<Vec2> gradients = trace(dark, frame, frame.record());
  EXPECT_GT(lit(gradients), gradients.size() / 2);
  for (size_t i = 0; i < gradients.size(); ++i) ASSERT_EQ(gradients[i].x, -gradients[i].y) << i;
}

TEST(Gradients, BrighterLampsAddTheirShare) {
  Scene source = named("cornell");
  CompiledScene scene(source, options());
  const TracedFrame frame(scene, {.seed = 7, .sample = 3});
  for (Material& material : source.materials) material.emission *= 2.0f;  // exact in floats
  const CompiledScene bright(std::move(source), options());
  for (const Vec2& g : trace(bright, frame, frame.record())) ASSERT_NEAR(g.x, 0.5f * g.y, 1e-5f * g.y);
}

TEST(Gradients, OnlySampledPixelsAreRecorded) {
  CompiledScene scene(named("cornell-closed"), options());
  TracedFrame frame(scene, {.seed = 7, .sample = 3});
  for (uint32_t i = 0; i < kPixels; ++i)
    frame.allocation.push_back(i % kWidth == i / kWidth / kStratum * kStratum ? 1u : 0u);
  size_t valid = 0;
  for (const GradientSample& sample : frame.record()) {
    if (!sample.hit.valid()) continue;
    ++valid;
    EXPECT_EQ(frame.allocation[sample.pixel], 1u);
  }
  EXPECT_EQ(valid, std::min(kColumns, kRows));  // one column of pixels in each stratum of the diagonal
}

TEST(Gradients, PixelsOfAStratumAreRecordedEquallyOften) {
  CompiledScene scene(named("cornell-closed"), options());
  TracedFrame frame(scene, {.seed = 7, .sample = 3});
  constexpr uint32_t kFrames = 16;
  constexpr uint32_t kCells = kStratum * kStratum;
  uint32_t counts[kCells] = {};
  uint32_t total = 0;
  for (uint32_t i = 0; i < kFrames; ++i) {
    frame.index.frame = i;
    const std::vector<GradientSample> samples = frame.record();
    for (size_t s = 0; s + kColumns < samples.size(); ++s) {  // without the incomplete row
      if (!samples[s].hit.valid()) continue;
      const uint32_t x = samples[s].pixel % kWidth;
      const uint32_t y = samples[s].pixel / kWidth;
      EXPECT_EQ(y / kStratum * kColumns + x / kStratum, s);
      ++counts[y % kStratum * kStratum + x % kStratum];
      ++total;
    }
  }
  const double expected = static_cast<double>(total) / kCells;
  double chi2 = 0;
  for (const uint32_t count : counts) chi2 += (count - expected) * (count - expected) / expected;
  EXPECT_LT(chi2, 26.1);  // 8 degrees of freedom: one in a thousand
}

TEST(Gradients, NearestSampleOfAStratumWins) {
  CompiledScene scene(named("cornell-closed"), options());
  const TracedFrame frame(scene, {.seed = 7, .sample = 3});
  std::vector<GradientSample> samples = frame.record();
  std::vector<uint64_t> votes(samples.size(), kNoVote);
  // The last sample has no surface, as in a damaged checkpoint.
  samples.back().hit.primitive = 0x7fffffffu;
  const ProjectSamplesKernel project{scene.view(), view_of(samples), mutable_view_of(votes), kColumns, kWidth, kHeight};
  for (uint32_t y = kRows; y-- > 0;) {
    for (uint32_t x = kColumns; x-- > 0;) project(x, y);
  }
  std::vector<size_t> found(samples.size());
  size_t own = 0;
  for (size_t s = 0; s < votes.size(); ++s) {
    if (votes[s] == kNoVote) continue;
    const auto source = static_cast<uint32_t>(votes[s]);
    ++found[source];
    own += source == s ? 1 : 0;
    const Vec3 p = surface_position(scene.view(), samples[source].hit).now;
    EXPECT_EQ(votes[s], vote_of(glm::length(p - scene.view().camera.position), source));
  }
  EXPECT_GT(own, samples.size() * 95 / 100) << "at rest, samples stay in their strata";
  EXPECT_LE(*std::max_element(found.begin(), found.end()), 1u);
  EXPECT_EQ(found.back(), 0u);
}

}  // namespace
}  // namespace relume
