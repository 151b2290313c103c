// The contract of light selectors, applied to every one of the closed list over scenes with all kinds of lights:
// probabilities sum to one, samples follow them, and the rest of the random number is uniform.
#include "techniques/light_selector.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scene/testing/light_scene.h"
#include "testing/chi2.h"
#include "testing/random.h"

namespace relume {
namespace {

/// Checks `selector` over `light_count` lights at `sp`.
void check_light_selector(const LightSelector& selector, const SurfacePoint& sp, uint32_t light_count,
                          const std::string& name) {
  double sum = 0;
  for (LightId i = 0; i < light_count; ++i) {
    ASSERT_GE(selector.pmf(sp, i), 0.0f) << name;
    sum += selector.pmf(sp, i);
  }
  ASSERT_NEAR(sum, 1.0, 1e-5) << name;  // a rounding a light

  constexpr int kSamples = 100000;
  std::vector<uint64_t> counts(light_count, 0);
  std::vector<uint64_t> rest(32, 0);
  testing::Random random(71);
  for (int i = 0; i < kSamples; ++i) {
    const LightSelection s = selector.sample(sp, random.next());
    ASSERT_LT(s.light, light_count) << name;
    ASSERT_GT(s.pmf, 0.0f) << name;
    ASSERT_FLOAT_EQ(s.pmf, selector.pmf(sp, s.light)) << name;
    ASSERT_TRUE(s.u >= 0.0f && s.u < 1.0f) << name;
    ++counts[s.light];
    ++rest[static_cast<size_t>(s.u * 32)];
  }
  std::vector<double> expected;
  for (LightId i = 0; i < light_count; ++i) expected.push_back(double{selector.pmf(sp, i)} * kSamples);
  EXPECT_GT(testing::chi2_test(counts, expected).p_value, testing::significance()) << name;
  EXPECT_GT(testing::chi2_test(rest, std::vector<double>(32, kSamples / 32.0)).p_value, testing::significance())
      << name;
  for (const float u : {0.0f, kOneMinusEpsilon}) EXPECT_GT(selector.sample(sp, u).pmf, 0.0f) << name;
}

TEST(LightSelector, EveryKindKeepsTheContract) {
  Environment sky;
  sky.kind = EnvironmentKind::sun_sky;
  for (const Environment& environment :
       {Environment{}, testing::constant_environment(), testing::noise_environment(24, 12), sky}) {
    const testing::LightScene scene = testing::make_light_scene(environment);
    const LightsView& lights = scene.lights();
    const auto entries = build_power_lights(lights);
    for (int k = 0; k < kLightSelectorKindCount; ++k) {
      LightSelector selector;
      selector.kind = static_cast<LightSelectorKind>(k);
      selector.uniform = make_uniform_lights(lights);
      selector.power = {{view_of(entries)}};
      check_light_selector(selector, SurfacePoint{}, lights.lights.size, "selector " + std::to_string(k));
    }
  }
}

TEST(LightSelector, FindsNothingWhereThereIsNothing) {
  for (int k = 0; k < kLightSelectorKindCount; ++k) {
    LightSelector selector;
    selector.kind = static_cast<LightSelectorKind>(k);
    EXPECT_EQ(selector.sample(SurfacePoint{}, 0.5f).pmf, 0.0f);
    EXPECT_EQ(selector.pmf(SurfacePoint{}, 0), 0.0f);
  }
}

}  // namespace
}  // namespace relume
