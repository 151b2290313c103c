#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "frame/pipeline.h"
#include "render/build_pipeline.h"
#include "techniques/reuse/reservoir/testing/fewer_paths.h"
#include "techniques/reuse/restir_gi/testing/image_means.h"
#include "techniques/reuse/restir_gi/testing/posts.h"
#include "techniques/transport/path/indirect_sample.h"

namespace relume {
namespace {

using testing::error_of;
using testing::FewerPaths;
using testing::Measured;
using testing::reuse_settings;

constexpr int kSeeds = 20;
constexpr int kMoving = 6;
constexpr int kKept = 8;

std::vector<Measured> reference_of(const Scene& scene, int max_bounces = 2) {
  RenderSettings settings = reuse_settings(ReuseChoice::none);
  settings.path.max_bounces = max_bounces;
  return testing::after_moves(scene, settings, 12, kMoving, 96);
}

const std::vector<Measured>& posts_reference() {
  static const std::vector<Measured> truth = reference_of(testing::posts());
  return truth;
}

/// Compares the mean of the image, then those of its blocks, which show darkening at edges. `bias`: relative.
void expect_equal(const std::vector<Measured>& reused, const std::vector<Measured>& truth, double bias = 0) {
  EXPECT_LT(error_of(reused[0], truth[0]), 0.02 * truth[0].mean);
  for (size_t k = 0; k < (bias > 0 ? size_t{1} : truth.size()); ++k) {
    // With few degrees of freedom, standard errors are uncertain.
    const double tolerance = bias * truth[k].mean + (k == 0 ? 6 : 7) * error_of(reused[k], truth[k]) + 1e-6;
    EXPECT_NEAR(reused[k].mean, truth[k].mean, tolerance) << (k == 0 ? "image" : "block ") << k;
  }
}

class RestirGiMode : public ::testing::TestWithParam<RestirGiSettings> {};

TEST_P(RestirGiMode, HasTheMeanOfPathTracingInImageAndBlocks) {
  RenderSettings settings = reuse_settings(ReuseChoice::restir_gi);
  settings.restir_gi = GetParam();
  settings.restir_gi.radius = 6;
  expect_equal(testing::after_moves(testing::posts(), settings, kSeeds, kMoving, kKept), posts_reference());
}

std::string mode_name(const ::testing::TestParamInfo<RestirGiSettings>& info) {
  const RestirGiSettings& s = info.param;
  return "cap_" + std::to_string(s.cap) + "_neighbours_" + std::to_string(s.neighbours) +
         (s.feedback == ReuseFeedback::spatial ? "_spatial" : "_temporal") +
         (s.correction == ReuseCorrection::exact ? "" : "_lagging") + (s.jacobian < 2 ? "_near" : "");
}

INSTANTIATE_TEST_SUITE_P(Unbiased, RestirGiMode,
                         ::testing::Values(RestirGiSettings{.cap = 0, .neighbours = 0}, RestirGiSettings{.cap = 0},
                                           RestirGiSettings{.neighbours = 0},
                                           RestirGiSettings{.feedback = ReuseFeedback::temporal, .cap = 8},
                                           RestirGiSettings{.cap = 8}, RestirGiSettings{.cap = 8, .jacobian = 1.2f},
                                           RestirGiSettings{
                                               .correction = ReuseCorrection::lagging, .cap = 8, .validate = 2}),
                         mode_name);

/// Pixels without a path pass their reservoirs to neighbours and later frames.
class RestirGiFewerPaths : public ::testing::TestWithParam<FewerPaths> {};

TEST_P(RestirGiFewerPaths, HasTheMeanOfPathTracingInImageAndBlocks) {
  RenderSettings settings = reuse_settings(ReuseChoice::restir_gi);
  settings.restir_gi.cap = 8;
  testing::apply(GetParam(), settings);
  expect_equal(testing::after_moves(testing::posts(), settings, 48, kMoving, 24), posts_reference(),
               testing::bias_of(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Exact, RestirGiFewerPaths,
                         ::testing::Values(FewerPaths::upscaled, FewerPaths::adaptive,
                                           FewerPaths::adaptive_after_pilot),
                         [](const auto& test) { return testing::name_of(test.param); });

TEST(RestirGiSparse, PixelsWithoutAPathKeepReservoirsWhileTheSceneRests) {
  RenderSettings settings = reuse_settings(ReuseChoice::restir_gi);
  settings.upscaling.factor = 2;
  Session session(testing::posts(), settings);
  testing::expect_reservoirs_to_be_kept<IndirectVertex>(session, "restir-gi", testing::ceiling_lamp(Rgb(5)));
}

/// Sheets with stochastic alpha are occluders and vertices.
TEST(RestirGiAlpha, HasTheMeanOfPathTracing) {
  Scene scene = testing::posts();
  Material veil = testing::matte(Rgb(0.3f, 0.6f, 0.4f));
  veil.alpha_mode = AlphaMode::blend;
  veil.alpha = 0.4f;
  testing::add_mesh(scene, veil, quad({-3, 1.5f, -3}, {6, 0, 0}, {0, 0, 6}));
  RenderSettings settings = reuse_settings(ReuseChoice::restir_gi);
  settings.restir_gi.cap = 8;
  expect_equal(testing::after_moves(scene, settings, kSeeds, kMoving, kKept), reference_of(scene));
}

/// Coloured walls and glossy boxes, with several bounces, in the light of the lamp that also shines directly.
TEST(RestirGiBox, HasTheMeanOfPathTracing) {
  const Scene scene = find_builtin_scene("cornell")->build();
  RenderSettings settings = reuse_settings(ReuseChoice::restir_gi);
  settings.restir_gi.cap = 8;
  settings.path.max_bounces = 5;
  expect_equal(testing::after_moves(scene, settings, kSeeds, kMoving, kKept), reference_of(scene, 5));
}

/// The mode "basic" never samples vertices that a pixel does not see, but its weights ignore that.
TEST(RestirGiBasic, LosesLightBetweenPosts) {
  RenderSettings settings = reuse_settings(ReuseChoice::restir_gi);
  settings.restir_gi.correction = ReuseCorrection::basic;
  settings.restir_gi.cap = 8;
  const Measured basic = testing::after_moves(testing::posts(), settings, kSeeds, kMoving, kKept)[0];
  const Measured truth = posts_reference()[0];
  EXPECT_LT(basic.mean - truth.mean, -4.5 * error_of(basic, truth));
  EXPECT_GT(basic.mean, 0.4 * truth.mean);
}

/// Variance of a frame's pixels between seeds, as a fraction of the squared mean.
double noise_of(const Scene& scene, const RenderSettings& settings) {
  constexpr size_t kPixels = size_t{testing::kReuseSize} * testing::kReuseSize;
  constexpr int kRuns = 12;
  Session session(Scene(scene), settings);
  std::vector<double> sum(kPixels);
  std::vector<double> squares(kPixels);
  for (int seed = 1; seed <= kRuns; ++seed) {
    session.restart(seed);
    for (int i = 0; i < 8; ++i) session.render_frame();
    const Image image = session.image();
    for (size_t p = 0; p < kPixels; ++p) {
      const double y = static_cast<double>(luminance(image.pixels[p]));
      sum[p] += y / kRuns;
      squares[p] += y * y / kRuns;
    }
  }
  double variance = 0;
  double mean = 0;
  for (size_t p = 0; p < kPixels; ++p) {
    variance += (squares[p] - sum[p] * sum[p]) / kPixels;
    mean += sum[p] / kPixels;
  }
  return variance / (mean * mean);
}

TEST(RestirGiNoise, FallsByReuse) {
  RenderSettings settings = reuse_settings(ReuseChoice::none);
  settings.history = HistoryChoice::none;
  const double of_paths = noise_of(testing::posts(), settings);
  settings.reuse = ReuseChoice::restir_gi;
  EXPECT_LT(noise_of(testing::posts(), settings), 0.6 * of_paths);
}

/// In the mode "exact", samples on glossy surfaces stay with their pixels. "reuse-glossy" reuses them, with bias.
TEST(RestirGiGlossyVertices, AreReusedOnRequest) {
  Material ceiling = testing::matte(Rgb(0.8f));
  ceiling.specular = 1;
  ceiling.roughness = 0.6f;
  const Scene scene = testing::posts_below(testing::matte(Rgb(0.6f)), ceiling);
  RenderSettings settings = reuse_settings(ReuseChoice::restir_gi);
  const Measured truth = reference_of(scene)[0];
  const Measured kept = testing::after_moves(scene, settings, kSeeds, kMoving, kKept)[0];
  EXPECT_NEAR(kept.mean, truth.mean, 6 * error_of(kept, truth));
  settings.restir_gi.reuse_glossy = true;
  const Measured reused = testing::after_moves(scene, settings, kSeeds, kMoving, kKept)[0];
  EXPECT_NEAR(reused.mean, truth.mean, 0.1 * truth.mean + 6 * error_of(reused, truth)) << "the bias is larger";
  settings.history = HistoryChoice::none;
  const double with = noise_of(scene, settings);
  settings.restir_gi.reuse_glossy = false;
  EXPECT_LT(with, 0.8 * noise_of(scene, settings));
}

/// Pixels of smooth glossy surfaces show the sample of their own path.
TEST(RestirGiGlossyReceivers, KeepTheirPaths) {
  Material floor = testing::matte(Rgb(0.6f));
  floor.specular = 1;
  floor.roughness = 0.2f;
  Scene scene = testing::plate(floor, 3, 1);
  scene.lights.push_back(testing::ceiling_lamp(Rgb(20)));
  Node node;
  node.light = 0;
  node.transform.translation = Vec3(0.3f, 1, 0.2f);
  node.transform.rotation = glm::angleAxis(kPi / 2, Vec3(1, 0, 0));
  scene.add_node(node);
  testing::add_mesh(scene, testing::matte(Rgb(0.8f)), quad({-3, 2, -3}, {6, 0, 0}, {0, 0, 6}));
  const auto rendered = [&](ReuseChoice reuse) {
    RenderSettings settings = reuse_settings(reuse);
    settings.history = HistoryChoice::none;
    Session session(Scene(scene), settings);
    for (int i = 0; i < 3; ++i) session.render_frame();
    return session.image();
  };
  const Image paths = rendered(ReuseChoice::none);
  const Image reused = rendered(ReuseChoice::restir_gi);
  double sum = 0;
  for (size_t p = 0; p < paths.pixels.size(); ++p) {
    const float y = luminance(paths.pixels[p]);
    ASSERT_NEAR(luminance(reused.pixels[p]), y, 1e-3f * (1.0f + y)) << p;
    sum += static_cast<double>(y);
  }
  EXPECT_GT(sum, 0);
}

TEST(RestirGiFrames, AreNotIndependent) {
  RenderSettings settings = reuse_settings(ReuseChoice::restir_gi);
  EXPECT_EQ(build_passes(settings, host_memory()).pipeline.correlated_frames(), 41u);
  EXPECT_FALSE(build_passes(settings, host_memory()).pipeline.keeps_to_pixels());
  settings.restir_gi.cap = 0;
  EXPECT_EQ(build_passes(settings, host_memory()).pipeline.correlated_frames(), 1u);
}

/// With one bounce there is no indirect light, and nothing to reuse.
TEST(RestirGiBounces, AreTwoAtLeast) {
  const auto rendered = [&](ReuseChoice reuse) {
    RenderSettings settings = reuse_settings(reuse);
    settings.path.max_bounces = 1;
    Session session(find_builtin_scene("cornell")->build(), settings);
    for (int i = 0; i < 3; ++i) session.render_frame();
    return session.image();
  };
  EXPECT_EQ(rendered(ReuseChoice::restir_gi).pixels, rendered(ReuseChoice::none).pixels);
}

}  // namespace
}  // namespace relume
