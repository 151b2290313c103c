// ReSTIR PT with learned lights and directions: images keep their mean, and candidates have less noise.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "frame/pipeline.h"
#include "render/build_pipeline.h"
#include "render/session.h"
#include "techniques/reuse/restir_di/testing/lamps_over_plate.h"
#include "techniques/reuse/restir_gi/testing/image_means.h"
#include "techniques/reuse/restir_pt/testing/expect_equal_means.h"
#include "techniques/reuse/restir_pt/testing/patch_beside_floors.h"

namespace relume {
namespace {

using testing::expect_equal;
using testing::Measured;

constexpr int kMoving = 6;
constexpr int kKept = 8;

RenderSettings settings_of(ReuseChoice reuse) {
  RenderSettings settings = testing::reuse_settings(reuse);
  settings.octree = {.collapse = 32, .split = 64, .scale = false};  // small images have few samples
  settings.restir_pt.radius = 6;
  settings.restir_pt.cap = 8;
  settings.path.max_bounces = 3;
  return settings;
}

struct Learned {
  const char* name;
  LightSelectionChoice lights = LightSelectionChoice::power;
  GuideChoice guide = GuideChoice::bsdf;
  PathShiftKind shift = PathShiftKind::hybrid;
};

void PrintTo(const Learned& learned, std::ostream* out) { *out << learned.name; }
std::string learned_name(const ::testing::TestParamInfo<Learned>& info) { return info.param.name; }

RenderSettings settings_of(const Learned& learned) {
  RenderSettings settings = settings_of(ReuseChoice::restir_pt);
  settings.lights = learned.lights;
  settings.guide = learned.guide;
  settings.restir_pt.shift = learned.shift;
  return settings;
}

/// Every frame repeats paths with what was learned when they were traced.
class RestirPtLearned : public ::testing::TestWithParam<Learned> {};

TEST_P(RestirPtLearned, HasTheMeanOfPathTracingInABox) {
  const Scene scene = find_builtin_scene("cornell")->build();
  static const std::vector<Measured> truth =
      testing::after_moves(scene, settings_of(ReuseChoice::none), 8, kMoving, 64);
  expect_equal(testing::after_moves(scene, settings_of(GetParam()), 24, kMoving, kKept), truth);
}

class RestirPtLearnedLamps : public RestirPtLearned {};

TEST_P(RestirPtLearnedLamps, HasTheMeanOfPathTracing) {
  const Scene scene = testing::cards_under_lamps();
  static const std::vector<Measured> truth =
      testing::after_moves(scene, settings_of(ReuseChoice::none), 8, kMoving, 64);
  expect_equal(testing::after_moves(scene, settings_of(GetParam()), 24, kMoving, kKept), truth);
}

INSTANTIATE_TEST_SUITE_P(
    Choices, RestirPtLearned,
    ::testing::Values(Learned{"vlc", LightSelectionChoice::vlc}, Learned{"neeat", LightSelectionChoice::neeat},
                      Learned{"mcls", LightSelectionChoice::mcls},
                      Learned{"cdq", LightSelectionChoice::power, GuideChoice::cdq},
                      Learned{"mcpg", LightSelectionChoice::power, GuideChoice::mcpg},
                      Learned{"vlc_cdq", LightSelectionChoice::vlc, GuideChoice::cdq},
                      Learned{"mcls_mcpg", LightSelectionChoice::mcls, GuideChoice::mcpg},
                      Learned{"neeat_cdq_reconnection", LightSelectionChoice::neeat, GuideChoice::cdq,
                              PathShiftKind::reconnection},
                      Learned{"vlc_mcpg_replay", LightSelectionChoice::vlc, GuideChoice::mcpg, PathShiftKind::replay}),
    learned_name);

INSTANTIATE_TEST_SUITE_P(Choices, RestirPtLearnedLamps,
                         ::testing::Values(Learned{"vlc", LightSelectionChoice::vlc},
                                           Learned{"neeat", LightSelectionChoice::neeat},
                                           Learned{"mcls", LightSelectionChoice::mcls},
                                           Learned{"vlc_cdq", LightSelectionChoice::vlc, GuideChoice::cdq}),
                         learned_name);

/// Sum over the pixels of the variance of candidates, after frames from which they have learned.
double noise_of(const Scene& scene, RenderSettings settings) {
  constexpr int kLearning = 64;
  constexpr int kMeasured = 64;
  settings.history = HistoryChoice::none;
  settings.restir_pt.cap = 0;
  settings.restir_pt.neighbours = 0;
  Session session(Scene(scene), settings);
  std::vector<double> sum(size_t{testing::kReuseSize} * testing::kReuseSize);
  std::vector<double> squares(sum.size());
  for (int frame = 0; frame < kLearning + kMeasured; ++frame) {
    session.render_frame();
    if (frame < kLearning) continue;
    const Image image = session.image();
    for (size_t p = 0; p < sum.size(); ++p) {
      const auto y = static_cast<double>(luminance(image.pixels[p]));
      sum[p] += y / kMeasured;
      squares[p] += y * y / kMeasured;
    }
  }
  double variance = 0;
  for (size_t p = 0; p < sum.size(); ++p) variance += squares[p] - sum[p] * sum[p];
  return variance;
}

/// Two of four equal lamps are hidden, which only learned selections know.
TEST(RestirPtLearnedLights, LowerTheNoise) {
  const Scene scene = testing::half_hidden_lamps();
  const double fixed = noise_of(scene, settings_of({"light_tree", LightSelectionChoice::light_tree}));
  EXPECT_GT(fixed, 0);
  for (const Learned& learned :
       {Learned{"vlc", LightSelectionChoice::vlc}, Learned{"neeat", LightSelectionChoice::neeat},
        Learned{"mcls", LightSelectionChoice::mcls}})
    EXPECT_LT(noise_of(scene, settings_of(learned)), 0.7 * fixed) << learned.name;
}

/// All light comes from a small bright patch, over the ceiling. Chains point at it. Quadtrees, which do not know its
/// distance, lower the noise here with neither restir-pt nor path.
TEST(RestirPtLearnedDirections, LowerTheNoise) {
  const Scene scene = testing::patch_beside_floors();
  const double fixed = noise_of(scene, settings_of(ReuseChoice::restir_pt));
  EXPECT_GT(fixed, 0);
  EXPECT_LT(noise_of(scene, settings_of({"mcpg", LightSelectionChoice::power, GuideChoice::mcpg})), 0.7 * fixed);
  EXPECT_NE(noise_of(scene, settings_of({"cdq", LightSelectionChoice::power, GuideChoice::cdq})), fixed);
}

/// What shifts evaluate again does not learn, so a light tree selects beside learned lights.
TEST(RestirPtLearnedPasses, IncludeALightTreeBesideLearnedLights) {
  const auto has_tree = [](const Learned& learned) {
    for (const PassDeclaration& pass : plan(settings_of(learned))) {
      if (pass.name == "light-tree") return true;
    }
    return false;
  };
  EXPECT_TRUE(has_tree({"vlc", LightSelectionChoice::vlc}));
  EXPECT_TRUE(has_tree({"mcls", LightSelectionChoice::mcls}));
  EXPECT_FALSE(has_tree({"cdq", LightSelectionChoice::power, GuideChoice::cdq}));
}

/// Reservoirs store points on lights.
TEST(RestirPtLearnedPasses, RequireNextEventEstimation) {
  RenderSettings settings = settings_of({"mcpg", LightSelectionChoice::power, GuideChoice::mcpg});
  EXPECT_EQ(refusal(settings), "");
  settings.mcpg.nee = false;
  EXPECT_NE(refusal(settings).find("'restir-pt'"), std::string::npos);
}

}  // namespace
}  // namespace relume
