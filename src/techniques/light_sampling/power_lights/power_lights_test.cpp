#include "techniques/light_sampling/power_lights/power_lights.h"

#include <gtest/gtest.h>

#include "scene/testing/light_scene.h"

namespace relume {
namespace {

double sum_of(const std::vector<AliasEntry>& entries, LightId first, LightId last) {
  double sum = 0;
  for (LightId i = first; i < last; ++i) sum += entries[i].pmf;
  return sum;
}

TEST(PowerLights, FollowsThePowerWithinFiniteAndInfiniteLights) {
  const testing::LightScene scene = testing::make_light_scene(testing::noise_environment(24, 12));
  const LightsView& lights = scene.lights();
  const auto entries = build_power_lights(lights);
  ASSERT_EQ(entries.size(), lights.lights.size);
  const auto ratio = [&](LightId a, LightId b) { return luminance(power(lights, a)) / luminance(power(lights, b)); };
  for (LightId i = 1; i < lights.lights.size; ++i) {
    const LightId other = i < lights.first_infinite ? 0 : lights.first_infinite;
    EXPECT_NEAR(entries[i].pmf / entries[other].pmf, ratio(i, other), 1e-4 * ratio(i, other)) << scene.named[i].name;
  }
  // Finite and infinite lights get one half each.
  EXPECT_NEAR(sum_of(entries, 0, lights.first_infinite), 0.5, 1e-5);
  EXPECT_NEAR(sum_of(entries, lights.first_infinite, lights.lights.size), 0.5, 1e-5);
}

TEST(PowerLights, LeavesAConstantEnvironmentToTheBsdf) {
  const testing::LightScene scene = testing::make_light_scene(testing::constant_environment());
  const auto entries = build_power_lights(scene.lights());
  EXPECT_EQ(entries.back().pmf, 0.0f);
  EXPECT_NEAR(sum_of(entries, 0, static_cast<LightId>(entries.size())), 1.0, 1e-5);
}

TEST(PowerLights, ReachesEveryLightThatEmits) {
  const testing::LightScene scene = testing::make_light_scene(testing::noise_environment(24, 12));
  for (const AliasEntry& e : build_power_lights(scene.lights())) EXPECT_GT(e.pmf, 0.0f);
}

TEST(PowerLights, OtherLightsRemainIfPowersOverflow) {
  std::vector<Light> lights(2);
  for (Light& light : lights) light.kind = LightKind::point;
  lights[0].point = {Vec3(0), Rgb(3e38f)};
  lights[1].point = {Vec3(0), Rgb(1e29f)};
  LightsView view;
  view.lights = view_of(lights);
  view.first_infinite = 2;
  const auto entries = build_power_lights(view);
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_GT(entries[0].pmf, 0.4f);
  EXPECT_GT(entries[1].pmf, 0.4f);
}

TEST(PowerLights, IsEmptyWithoutLights) {
  const PowerLights none;
  EXPECT_EQ(none.sample({0.5f, 1}).pmf, 0.0f);
  EXPECT_EQ(none.pmf(0), 0.0f);
  EXPECT_TRUE(build_power_lights(LightsView{}).empty());
}

}  // namespace
}  // namespace relume
