// Tests the choice among several lights at primary hits: bits, mean and noise.
#include "techniques/transport/path/resampled_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume {
namespace {

constexpr uint32_t kEdge = 20;
constexpr uint32_t kPixels = kEdge * kEdge;
constexpr uint32_t kSamples = 128;

struct ResamplingPolicy : NoPolicy {
  static constexpr bool resamples_lights = true;

  uint32_t connections = 0;

  void connected(const SurfacePoint&, const PathState& path, const Connection&, bool) {
    if (path.bounce == 0) ++connections;
  }
};
static_assert(kResamplesLights<ResamplingPolicy> && !kResamplesLights<NoPolicy>);
static_assert(kResamplesLights<PathPolicies<NoPolicy, ResamplingPolicy>> && !kResamplesLights<PathPolicies<NoPolicy>>);

struct ResamplingOutput {
  using Policy = ResamplingPolicy;

  View<Rgb> radiance;
  View<uint32_t> connections;  ///< of the primary hit

  ResamplingPolicy policy(const SampleIndex&, uint32_t, uint32_t, uint32_t) const { return {}; }
  void finish(uint32_t pixel, const ResamplingPolicy& policy, const PathState& path) const {
    radiance[pixel] = path.radiance;
    connections[pixel] = policy.connections;
  }
  void leave_out(uint32_t) const {}
};

CompiledScene compiled(Scene scene) {
  return CompiledScene(std::move(scene), CompileOptions{.camera = {}, .width = kEdge, .height = kEdge});
}
CompiledScene compiled(const char* name) { return compiled(find_builtin_scene(name)->build()); }

struct Traced {
  std::vector<Rgb> radiance = std::vector<Rgb>(kPixels);
  std::vector<uint32_t> connections = std::vector<uint32_t>(kPixels);
};

/// A sample of each pixel with light from one bounce, or from `max_bounces`.
Traced traced(const CompiledScene& scene, uint32_t candidates, uint32_t sample, uint32_t tile_size = kEdge,
              uint32_t max_bounces = 1) {
  Traced result;
  testing::trace_pixels(scene,
                        {.width = kEdge,
                         .height = kEdge,
                         .tile_size = tile_size,
                         .max_bounces = max_bounces,
                         .sample = sample,
                         .light_candidates = candidates},
                        ResamplingOutput{mutable_view_of(result.radiance), mutable_view_of(result.connections)});
  return result;
}

TEST(ResampledLight, OneCandidateHasTheBitsOfAPath) {
  const CompiledScene scene = compiled("cornell");
  std::vector<Rgb> expected(kPixels);
  testing::trace_pixels(scene, {.width = kEdge, .height = kEdge, .max_bounces = 3, .sample = 5},
                        RadianceOutput{mutable_view_of(expected)});
  EXPECT_EQ(traced(scene, 1, 5, 0, 3).radiance, expected);
  EXPECT_NE(traced(scene, 8, 5, 0, 3).radiance, expected);
}

TEST(ResampledLight, BatchesHaveTheBitsOfSinglePaths) {
  const CompiledScene scene = compiled("cornell");
  for (uint32_t sample = 0; sample < 4; ++sample)
    EXPECT_EQ(traced(scene, 8, sample, 7, 4).radiance, traced(scene, 8, sample, 0, 4).radiance) << sample;
}

TEST(ResampledLight, TracesOneShadowRay) {
  const Traced of_eight = traced(compiled("cornell"), 8, 0);
  EXPECT_EQ(*std::max_element(of_eight.connections.begin(), of_eight.connections.end()), 1u);
}

double mean_luminance(const std::vector<Rgb>& image) {
  double sum = 0;
  for (const Rgb& pixel : image) sum += static_cast<double>(luminance(pixel));
  return sum / static_cast<double>(image.size());
}

struct Mean {
  double value = 0;
  double error = 0;
};

/// Mean of `of_sample(sample)` over all samples.
template <typename OfSample>
Mean mean_over_samples(const OfSample& of_sample) {
  double sum = 0;
  double squares = 0;
  for (uint32_t sample = 0; sample < kSamples; ++sample) {
    const double value = of_sample(sample);
    sum += value;
    squares += value * value;
  }
  const double mean = sum / kSamples;
  return {mean, std::sqrt(std::max(squares / kSamples - mean * mean, 0.0) / (kSamples - 1))};
}

/// Every direction meets a light, so MIS shares all light. If weights of connections and of directions counted
/// different numbers of candidates, they would not add up to one.
TEST(ResampledLight, WeightsAddUpToOneInTheFurnace) {
  constexpr float kAlbedo = 0.8f;
  const CompiledScene scene = compiled(testing::closed_furnace(kAlbedo));
  const Mean mean =
      mean_over_samples([&](uint32_t sample) { return mean_luminance(traced(scene, 16, sample).radiance); });
  EXPECT_LT(mean.error, 0.005);
  EXPECT_NEAR(mean.value, testing::closed_furnace_radiance(static_cast<double>(kAlbedo), 1), 4.5 * mean.error);
}

/// Differences within a sample, in which the edges of the lamp cancel.
TEST(ResampledLight, KeepsTheMeanOfDirectLight) {
  for (const char* name : {"cornell", "cornell-mirror"}) {
    const CompiledScene scene = compiled(name);
    double sum = 0;
    const Mean difference = mean_over_samples([&](uint32_t sample) {
      const double one = mean_luminance(traced(scene, 1, sample).radiance);
      sum += one / kSamples;
      return mean_luminance(traced(scene, 16, sample).radiance) - one;
    });
    EXPECT_GT(difference.error, 0) << name;
    EXPECT_LT(difference.error, 0.01 * sum) << name;
    EXPECT_NEAR(difference.value, 0, 4.5 * difference.error) << name;
  }
}

/// Relative standard deviation of a sample; the median over pixels, because edges of lamps vary with the position in
/// the pixel.
double noise_of(const CompiledScene& scene, uint32_t candidates) {
  std::vector<double> sum(kPixels);
  std::vector<double> squares(kPixels);
  for (uint32_t sample = 0; sample < kSamples; ++sample) {
    const Traced one = traced(scene, candidates, sample);
    for (uint32_t p = 0; p < kPixels; ++p) {
      const auto y = static_cast<double>(luminance(one.radiance[p]));
      sum[p] += y / kSamples;
      squares[p] += y * y / kSamples;
    }
  }
  std::vector<double> noise;
  for (uint32_t p = 0; p < kPixels; ++p) {
    if (sum[p] > 0) noise.push_back(std::sqrt(std::max(squares[p] - sum[p] * sum[p], 0.0)) / sum[p]);
  }
  const auto middle = noise.begin() + static_cast<std::ptrdiff_t>(noise.size() / 2);
  std::nth_element(noise.begin(), middle, noise.end());
  return *middle;
}

TEST(ResampledLight, HasLessNoiseWithMoreCandidates) {
  const CompiledScene scene = compiled("warehouse");
  const double of_one = noise_of(scene, 1);
  EXPECT_GT(of_one, 0);
  EXPECT_LT(noise_of(scene, 32), 0.8 * of_one);
}

}  // namespace
}  // namespace relume
