#include "techniques/light_sampling/uniform_lights/uniform_lights.h"

#include <gtest/gtest.h>

#include "scene/testing/light_scene.h"

namespace relume {
namespace {

TEST(UniformLights, GivesEveryLightTheSameShareOfTheRandomNumber) {
  const UniformLights lights{4};
  for (uint32_t i = 0; i < 4; ++i) {
    const LightSelection s = lights.sample({0.25f * static_cast<float>(i) + 0.0625f, i});
    EXPECT_EQ(s.light, i);
    EXPECT_EQ(s.pmf, 0.25f);
    EXPECT_NEAR(s.u, 0.25f, 1e-6f);
  }
  EXPECT_EQ(lights.pmf(3), 0.25f);
  EXPECT_EQ(lights.pmf(4), 0.0f);
}

TEST(UniformLights, LeavesAConstantEnvironmentToTheBsdf) {
  const testing::LightScene constant = testing::make_light_scene(testing::constant_environment());
  EXPECT_EQ(make_uniform_lights(constant.lights()).count, constant.lights().lights.size - 1);
  const testing::LightScene map = testing::make_light_scene(testing::noise_environment(24, 12));
  EXPECT_EQ(make_uniform_lights(map.lights()).count, map.lights().lights.size);
  const testing::LightScene none = testing::make_light_scene({});
  EXPECT_EQ(make_uniform_lights(none.lights()).count, none.lights().lights.size);
}

}  // namespace
}  // namespace relume
