// Properties of the scenes of single experiments.
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <glm/trigonometric.hpp>

#include "builtin_scenes/testing/scene_queries.h"

namespace relume {
namespace {

using testing::scene_named;

/// The geometry is that of the mine, and only the sun's size differs.
TEST(MineSuns, HaveTheirDiameters) {
  const Scene& mine = scene_named("mine");
  EXPECT_FLOAT_EQ(mine.environment.sun_sky.sun_angular_diameter_rad, glm::radians(10.0f));
  const std::pair<const char*, float> suns[] = {{"mine-sun-5", 5}, {"mine-sun-2.5", 2.5f}, {"mine-sun-1", 1}};
  for (const auto& [name, degrees] : suns) {
    const Scene& scene = scene_named(name);
    EXPECT_FLOAT_EQ(scene.environment.sun_sky.sun_angular_diameter_rad, glm::radians(degrees)) << name;
    EXPECT_EQ(scene.environment.sun_sky.sun_scale, mine.environment.sun_sky.sun_scale) << name;
    EXPECT_EQ(scene.environment.sun_sky.sun_elevation_rad, mine.environment.sun_sky.sun_elevation_rad) << name;
    ASSERT_EQ(scene.meshes.size(), mine.meshes.size()) << name;
    for (size_t i = 0; i < mine.meshes.size(); ++i) EXPECT_EQ(scene.meshes[i].positions, mine.meshes[i].positions);
  }
}

}  // namespace
}  // namespace relume
