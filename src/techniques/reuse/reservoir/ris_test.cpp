#include "techniques/reuse/reservoir/ris.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "scene/compiled_scene.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume {
namespace {

constexpr int kSize = 20;

RenderSettings settings_of(ReuseChoice reuse) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.reuse = reuse;
  settings.path.max_bounces = 2;
  return settings;
}

struct Mean {
  double value = 0;
  double error = 0;
};

/// Mean luminance of an image over seeds.
Mean mean_over_seeds(const char* scene, const RenderSettings& settings, int frames, int seeds) {
  Session session(find_builtin_scene(scene)->build(), settings);
  double sum = 0;
  double squares = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    session.restart(seed);
    for (int i = 0; i < frames; ++i) session.render_frame();
    double mean = 0;
    for (const Rgb& pixel : session.image().pixels) mean += static_cast<double>(luminance(pixel)) / (kSize * kSize);
    sum += mean;
    squares += mean * mean;
  }
  const double mean = sum / seeds;
  return {mean, std::sqrt((squares / seeds - mean * mean) / (seeds - 1))};
}

void expect_equal(const Mean& a, const Mean& b) {
  const double error = std::hypot(a.error, b.error);
  EXPECT_LT(error, 0.015 * b.value);
  EXPECT_NEAR(a.value, b.value, 4.5 * error);
}

class RisInScene : public ::testing::TestWithParam<const char*> {};
TEST_P(RisInScene, HasTheMeanOfPathTracing) {
  RenderSettings paths = settings_of(ReuseChoice::none);
  paths.path.max_bounces = 1;
  RenderSettings reservoirs = paths;
  reservoirs.reuse = ReuseChoice::ris;
  expect_equal(mean_over_seeds(GetParam(), reservoirs, 16, 12), mean_over_seeds(GetParam(), paths, 32, 12));
}
std::string scene_name(const ::testing::TestParamInfo<const char*>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Scenes, RisInScene, ::testing::Values("cornell", "cornell-mirror"), scene_name);

TEST(Ris, KeepsTheMeanWithIndirectLightInHalfOfThePixels) {
  RenderSettings half = settings_of(ReuseChoice::ris);
  half.path.indirect_rate = 0.5f;
  expect_equal(mean_over_seeds("cornell", half, 16, 12),
               mean_over_seeds("cornell", settings_of(ReuseChoice::none), 32, 12));
}

/// Cells have the same bias with better samples of light: their mean and edges stay.
class RisWithCache : public ::testing::TestWithParam<CacheChoice> {};
TEST_P(RisWithCache, HasTheMeanOfTheCache) {
  RenderSettings cached = settings_of(ReuseChoice::none);
  cached.cache = GetParam();
  RenderSettings resampled = cached;
  resampled.reuse = ReuseChoice::ris;
  expect_equal(mean_over_seeds("cornell", resampled, 32, 12), mean_over_seeds("cornell", cached, 32, 12));
}
INSTANTIATE_TEST_SUITE_P(Caches, RisWithCache,
                         ::testing::Values(CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg, CacheChoice::apsf_apg,
                                           CacheChoice::sharc));

/// Relative standard deviation of a pixel's single sample; the median over pixels, because the edges of lamps vary with
/// the position in the pixel.
double noise_of(const RenderSettings& settings) {
  Session session(find_builtin_scene("warehouse")->build(), settings);
  constexpr int kFrames = 64;
  std::vector<double> sum(kSize * kSize);
  std::vector<double> squares(kSize * kSize);
  for (int i = 0; i < kFrames; ++i) {
    session.render_frame();
    const Image image = session.image();
    for (size_t p = 0; p < sum.size(); ++p) {
      const auto y = static_cast<double>(luminance(image.pixels[p]));
      sum[p] += y / kFrames;
      squares[p] += y * y / kFrames;
    }
  }
  std::vector<double> noise;
  for (size_t p = 0; p < sum.size(); ++p) {
    if (sum[p] > 0) noise.push_back(std::sqrt(std::max(squares[p] - sum[p] * sum[p], 0.0)) / sum[p]);
  }
  const auto middle = noise.begin() + static_cast<std::ptrdiff_t>(noise.size() / 2);
  std::nth_element(noise.begin(), middle, noise.end());
  return *middle;
}

TEST(Ris, HasLessNoiseWithMoreCandidates) {
  RenderSettings settings = settings_of(ReuseChoice::ris);
  settings.history = HistoryChoice::none;
  settings.path.max_bounces = 1;
  settings.ris.candidates = 1;
  const double of_one = noise_of(settings);
  settings.ris.candidates = 32;
  EXPECT_GT(of_one, 0);
  EXPECT_LT(noise_of(settings), 0.8 * of_one);
}

/// With one bounce, only primary hits choose lights, among candidates. The share of the light tree in their choice
/// changes it once cells have states.
TEST(Ris, TeachesChainsOfLights) {
  const auto pixels_of = [](int frames, float base_fraction) {
    RenderSettings settings = settings_of(ReuseChoice::ris);
    settings.history = HistoryChoice::none;
    settings.path.max_bounces = 1;
    settings.lights = LightSelectionChoice::mcls;
    settings.mcls.base_fraction = base_fraction;
    Session session(find_builtin_scene("cornell")->build(), settings);
    for (int i = 0; i < frames; ++i) session.render_frame();
    return session.image().pixels;
  };
  EXPECT_EQ(pixels_of(1, 0.5f), pixels_of(1, 1.0f));
  EXPECT_NE(pixels_of(3, 0.5f), pixels_of(3, 1.0f));
}

TEST(Ris, AddsNothingWithoutScattering) {
  RenderSettings settings = settings_of(ReuseChoice::none);
  settings.path.max_bounces = 0;
  Session plain(find_builtin_scene("cornell")->build(), settings);
  settings.reuse = ReuseChoice::ris;
  Session reservoirs(find_builtin_scene("cornell")->build(), settings);
  plain.render_frame();
  reservoirs.render_frame();
  EXPECT_EQ(plain.image().pixels, reservoirs.image().pixels);
}

TEST(FirstNeeBounce, LeavesDirectLightOut) {
  constexpr uint32_t kEdge = 24;
  const CompiledScene scene(find_builtin_scene("cornell")->build(),
                            CompileOptions{.camera = {}, .width = kEdge, .height = kEdge});
  const auto traced = [&](uint32_t max_bounces, uint32_t first_nee_bounce) {
    std::vector<Rgb> radiance(kEdge * kEdge);
    testing::trace_pixels(
        scene, {.width = kEdge, .height = kEdge, .max_bounces = max_bounces, .first_nee_bounce = first_nee_bounce},
        RadianceOutput{mutable_view_of(radiance)});
    return radiance;
  };
  EXPECT_EQ(traced(1, 1), traced(0, 0)) << "the lamp itself";
  EXPECT_NE(traced(2, 1), traced(0, 0)) << "light of the second bounce remains";
  EXPECT_NE(traced(1, 0), traced(0, 0));
}

TEST(FirstScatter, MeetsTheLampOrLeavesTheBox) {
  constexpr uint32_t kEdge = 24;
  const CompiledScene scene(find_builtin_scene("cornell")->build(),
                            CompileOptions{.camera = {}, .width = kEdge, .height = kEdge});
  std::vector<FirstScatter> scatters(kEdge * kEdge);
  std::vector<Rgb> radiance(scatters.size());
  int lamps = 0;
  int open = 0;
  for (uint32_t sample = 0; sample < 32; ++sample) {
    testing::trace_pixels(scene, {.width = kEdge, .height = kEdge, .max_bounces = 2, .sample = sample},
                          RadianceOutput{mutable_view_of(radiance)}, FirstScatterOutput{mutable_view_of(scatters)});
    for (const FirstScatter& s : scatters) {
      if (!(s.pdf_w > 0.0f)) continue;
      ASSERT_NEAR(glm::length(s.direction), 1, 1e-5f);
      if (s.light == kNoLight) {
        ++open;  // through the box's front
      } else {
        ++lamps;
        ASSERT_LT(s.light, scene.view().lights.lights.size);
        ASSERT_TRUE(s.barycentric.x >= 0.0f && s.barycentric.y >= 0.0f && s.barycentric.x + s.barycentric.y <= 1.001f);
      }
    }
  }
  EXPECT_GT(lamps, 100);
  EXPECT_GT(open, 100);
}

/// Paths of caches sample lobes with raised colours. A direction counts by the density of the receiver's lobes, so its
/// weight is lower where the path sampled it more densely.
TEST(ScatterWeight, CorrectsForTheDensityOfOtherLobes) {
  constexpr uint32_t kEdge = 24;
  const CompiledScene scene(find_builtin_scene("cornell")->build(),
                            CompileOptions{.camera = {}, .width = kEdge, .height = kEdge});
  const SceneView view = scene.view();
  PathContext context;
  context.scene = view;
  context.selector.kind = LightSelectorKind::uniform;
  context.selector.uniform = make_uniform_lights(view.lights);
  const CandidateSource own{context, 4};
  const CandidateSource rare{context, 4, 0.25f};
  const CandidateSource raised{context, 4, 1.0f, false};
  std::vector<Hit> hits(kEdge * kEdge);
  std::vector<FirstScatter> scatters(hits.size());
  std::vector<Rgb> radiance(hits.size());
  int tested = 0;
  for (uint32_t sample = 0; sample < 32; ++sample) {
    const SampleIndex index{.seed = 7, .sample = sample};  // that of trace_pixels()
    const PrimaryHitsKernel primary{view, index, mutable_view_of(hits), {}, kEdge};
    testing::trace_pixels(scene, {.width = kEdge, .height = kEdge, .max_bounces = 2, .sample = sample},
                          RadianceOutput{mutable_view_of(radiance)}, FirstScatterOutput{mutable_view_of(scatters)});
    for (uint32_t p = 0; p < kEdge * kEdge; ++p) {
      const FirstScatter& s = scatters[p];
      if (!(s.pdf_w > 0.0f) || s.light == kNoLight) continue;
      primary(p % kEdge, p / kEdge);
      Receiver r;
      make_receiver(view, record_of(view, p % kEdge, p / kEdge, index.sampler(p % kEdge, p / kEdge), hits[p]), r);
      const LightPoint point = point_along(view.lights, s.light, r.sp.position, s.direction, s.barycentric);
      const float weight = weight_of_scatter(own, r, point, s.pdf_w, 1.0f);
      if (!(weight > 0.0f)) continue;
      ++tested;
      ASSERT_NEAR(weight_of_scatter(raised, r, point, s.pdf_w, 1.0f), weight, 1e-3f * weight);
      ASSERT_NEAR(weight_of_scatter(raised, r, point, 4 * s.pdf_w, 1.0f), weight / 4, 1e-3f * weight);
      // Light selection counts for more where paths rarely have a direction.
      ASSERT_GT(weight_of_scatter(rare, r, point, s.pdf_w, 1.0f), weight);
    }
  }
  EXPECT_GT(tested, 50);
}

}  // namespace
}  // namespace relume
