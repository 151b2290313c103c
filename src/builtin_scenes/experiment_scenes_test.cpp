// Properties of the scenes of single experiments.
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <glm/trigonometric.hpp>

#include "builtin_scenes/testing/scene_queries.h"

namespace relume {
namespace {

using testing::emissive_count;
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

TEST(WarehouseLayouts, HaveTheirLamps) {
  EXPECT_EQ(emissive_count(scene_named("warehouse-rooms")), 2u * 25 * 14);
  EXPECT_EQ(emissive_count(scene_named("warehouse-140")), 2u * 140 * 3);
  EXPECT_EQ(emissive_count(scene_named("warehouse-399")), 2u * 399);
}

/// Bays of 4.4 m have lamps of the same total power, however many.
TEST(WarehouseLayouts, BaysHaveTheSamePower) {
  const auto area_per_bay = [](const Scene& scene, float bays) {
    float area = 0;
    for (const Mesh& mesh : scene.meshes) {
      if (is_black(scene.materials[static_cast<size_t>(mesh.material)].emission)) continue;
      for (const UVec3& t : mesh.triangles) {
        const Vec3 a = mesh.positions[t.x];
        area += 0.5f * glm::length(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a));
      }
    }
    return area / bays;
  };
  const float three = area_per_bay(scene_named("warehouse-140"), 140);
  EXPECT_NEAR(area_per_bay(scene_named("warehouse-399"), 399), three, 1e-3f * three);  // sums of floats
}

}  // namespace
}  // namespace relume
