// Samples of indirect light from bidirectional paths, and the light that stays with these.
#include "techniques/transport/bdpt/subpath_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "techniques/transport/bdpt/testing/bdpt_frame.h"
#include "techniques/transport/bdpt/testing/random_guides.h"
#include "techniques/transport/bdpt/testing/zoo.h"

namespace relume::testing {
namespace {

/// Frames whose camera subpaths record samples.
struct SampledFrame {
  SampledFrame(Scene scene, const BdptOptions& options)
      : frame(std::move(scene), options), samples(frame.hits.size()), light(frame.hits.size()) {}

  /// Traces sample `i` of every pixel. `radiance` of the frame then lacks splats.
  template <typename Context>
  void trace(Context c, uint32_t i) {
    c.path.indirect_to_reservoirs = true;
    const BdptKernel plain{frame.context(),
                           frame.find_hits(1, i),
                           view_of(frame.hits),
                           view_of(frame.allocation),
                           {mutable_view_of(frame.radiance)},
                           mutable_view_of(frame.rays),
                           {&frame.saturated, 1},
                           {&frame.nonfinite, 1}};
    const SubpathSamples output{mutable_view_of(frame.radiance), {mutable_view_of(samples)}};
    launch(frame.backend, "trace", plain.with(c, output), frame.width(), frame.height());
    for (size_t p = 0; p < light.size(); ++p) {
      light[p] = frame.splats[p].value();
      frame.splats[p] = {};
    }
  }
  void trace(uint32_t i) { trace(frame.context(), i); }

  BdptFrame frame;
  std::vector<IndirectSample> samples;
  std::vector<Rgb> light;  ///< splats
};

constexpr float kAlbedo = 0.6f;

/// In a closed sphere of radiance 1, second vertices reflect Σ ρ^k, and the rest of the light is 1 + ρ.
TEST(SubpathSamples, HaveTheLightOfAClosedFurnace) {
  constexpr uint32_t kFrames = 32;
  for (uint32_t bounces = 2; bounces <= 5; ++bounces) {
    SampledFrame f(make_closed_sphere(kAlbedo), {.max_bounces = bounces, .russian_roulette = false});
    const double share = 1.0 / (kFrames * static_cast<double>(f.light.size()));
    double of_samples = 0;
    double of_rest = 0;
    double of_splats = 0;
    for (uint32_t i = 0; i < kFrames; ++i) {
      f.trace(i);
      for (size_t p = 0; p < f.light.size(); ++p) {
        of_samples += static_cast<double>(f.samples[p].vertex.radiance.g) * share;
        of_rest += static_cast<double>(f.frame.radiance[p].g + f.light[p].g) * share;
        of_splats += static_cast<double>(f.light[p].g) * share;
      }
    }
    double expected = 0;
    for (uint32_t k = 1; k < bounces; ++k) expected += std::pow(static_cast<double>(kAlbedo), k);
    EXPECT_NEAR(of_samples / expected, 1, 0.02) << bounces << " bounces";
    EXPECT_NEAR(of_rest / (1 + static_cast<double>(kAlbedo)), 1, 0.02) << bounces << " bounces";
    EXPECT_GT(of_splats, 0.01) << "light subpaths still find direct light";
  }
}

/// With one bounce, no second vertex reflects light.
TEST(SubpathSamples, DoNotExistWithOneBounce) {
  SampledFrame f(make_closed_sphere(kAlbedo), {.max_bounces = 1});
  f.trace(0);
  for (const IndirectSample& sample : f.samples) EXPECT_EQ(sample.weight, 0.0f);
}

TEST(SubpathSamples, DoNotExistInPixelsWithoutAPath) {
  SampledFrame f(make_closed_sphere(kAlbedo), {});
  f.trace(0);
  EXPECT_GT(f.samples[5].weight, 0.0f);
  f.frame.allocation.assign(f.light.size(), 0);
  f.trace(1);
  for (size_t p = 0; p < f.light.size(); ++p) {
    EXPECT_EQ(f.samples[p].weight, 0.0f);
    EXPECT_TRUE(is_black(f.frame.radiance[p]));
  }
}

/// Light that light subpaths add to the image, if reservoirs take all light that they can.
double left_splats(const char* scene) {
  SampledFrame f(find_builtin_scene(scene)->build(), {.width = 24, .height = 24, .first_nee_bounce = 1});
  double sum = 0;
  for (uint32_t i = 0; i < 16; ++i) {
    f.trace(i);
    for (const Rgb& splat : f.light) sum += static_cast<double>(luminance(splat));
  }
  return sum / (16 * static_cast<double>(f.light.size()));
}

/// Only light that arrives through a delta lobe is left for splats.
TEST(SubpathSamples, LeaveCausticsToSplats) {
  EXPECT_EQ(left_splats("cornell"), 0.0);
  EXPECT_GT(left_splats("cornell-glass"), 1e-4);
  EXPECT_GT(left_splats("cornell-water"), 1e-4);
}

/// Where the second vertex only scatters by delta lobes, the light stays with the subpath.
TEST(SubpathSamples, AreNeverOnMirrors) {
  SampledFrame f(find_builtin_scene("cornell-spheres")->build(), {.width = 32, .height = 32});
  int found = 0;
  int lit = 0;
  for (uint32_t i = 0; i < 4; ++i) {
    f.trace(i);
    for (const IndirectSample& sample : f.samples) {
      if (!(sample.weight > 0.0f)) continue;
      ++found;
      lit += is_black(sample.vertex.radiance) ? 0 : 1;
      EXPECT_GT(sample.vertex.alpha, 0.0f);
    }
  }
  EXPECT_GT(found, 1000);
  EXPECT_GT(lit, found / 2);
}

/// Samples of 32 frames of the zoo that stay in their pixels. It has glass with this dispersion.
int count_bound(float dispersion, const BdptOptions& options) {
  Scene scene = make_zoo(ZooLight::triangles, ZooCamera::pinhole);
  SampledFrame f(dispersion > 0.0f ? dispersive(std::move(scene), dispersion) : std::move(scene), options);
  int found = 0;
  int bound = 0;
  for (uint32_t i = 0; i < 32; ++i) {
    f.trace(i);
    for (const IndirectSample& sample : f.samples) {
      if (!(sample.weight > 0.0f)) continue;
      ++found;
      bound += sample.vertex.has(IndirectVertex::kBound) ? 1 : 0;
    }
  }
  EXPECT_GT(found, 500);
  return bound;
}

/// Connections to dispersive glass carry a weight of the pixel's wavelength. Camera subpaths are the same without light
/// subpaths, so only connections bind more samples.
TEST(SubpathSamples, ThatDependOnTheWavelengthStayInTheirPixels) {
  const BdptOptions connected{.max_bounces = 4, .russian_roulette = false};
  const BdptOptions alone{.max_bounces = 4, .russian_roulette = false, .max_light_vertices = 1};
  EXPECT_GT(count_bound(10, alone), count_bound(0, alone));
  EXPECT_GT(count_bound(10, connected), count_bound(10, alone));
}

/// Roulette depends on the light of the pixel.
TEST(SubpathSamples, StayInTheirPixelsWhateverRouletteSelects) {
  const BdptOptions all{.max_bounces = 4, .russian_roulette = false};
  BdptOptions few = all;
  few.connection_roulette = 1;
  EXPECT_EQ(count_bound(10, few), count_bound(10, all));
}

/// Directions from the first surfaces that are chosen for the light that stays with subpaths; 0: none.
std::vector<uint32_t> chosen_directions(uint32_t bounces) {
  SampledFrame f(make_zoo(ZooLight::point, ZooCamera::pinhole, false), {.max_bounces = bounces});
  std::vector<FirstVertex> vertices(f.light.size());
  std::vector<uint64_t> chosen(f.light.size());
  std::vector<uint64_t> of_splats(f.light.size());
  BdptContext c = f.frame.context();
  c.first_light = {.vertices = mutable_view_of(vertices),
                   .chosen = mutable_view_of(chosen),
                   .seed = 3,
                   .splats = mutable_view_of(of_splats)};
  f.trace(c, 0);
  std::vector<uint32_t> directions;
  for (const uint64_t key : chosen) directions.push_back(static_cast<uint32_t>(key));
  return directions;
}

/// No direction meets a point light, so the light that stays comes from connections to it, as with one bounce.
TEST(SubpathSamples, AreNoLightOfRecordedDirections) {
  const std::vector<uint32_t> direct = chosen_directions(1);
  EXPECT_GT(std::count_if(direct.begin(), direct.end(), [](uint32_t direction) { return direction != 0; }), 50);
  EXPECT_EQ(chosen_directions(5), direct);
}

/// Records of vertices have weights of their own, so it does not matter which light becomes a sample.
TEST(SubpathSamples, ChangeNoRecords) {
  constexpr uint32_t kVertices = 3;
  const BdptOptions options{.max_bounces = 5, .russian_roulette = false};
  SampledFrame f(make_zoo(ZooLight::triangles, ZooCamera::pinhole), options);
  RandomGuides guides(f.frame.backend, f.frame.compiled.view());
  std::vector<VertexSample> records(f.light.size() * kVertices);
  LearningContext c{f.frame.context()};
  guides.guide(c);
  c.path.indirect_to_reservoirs = true;  // random numbers of rays depend on it
  c.recording.samples = mutable_view_of(records);
  c.recording.vertices = kVertices;
  c.recording.pixels = static_cast<uint32_t>(f.light.size());
  int compared = 0;
  int wrong = 0;
  for (uint32_t i = 0; i < 16; ++i) {
    f.frame.run_in(c, 1, i);
    const std::vector<VertexSample> plain = records;
    f.trace(c, i);
    for (size_t r = 0; r < records.size(); ++r) {
      if (!(plain[r].value > 0.0f)) continue;
      ++compared;
      wrong += std::fabs(records[r].value - plain[r].value) <= 1e-3f * plain[r].value ? 0 : 1;
    }
  }
  EXPECT_GT(compared, 500);
  EXPECT_LE(wrong * 100, compared);
}

}  // namespace
}  // namespace relume::testing
