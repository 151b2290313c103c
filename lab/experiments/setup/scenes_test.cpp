#include "experiments/setup/scenes.h"

#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(ExperimentScenes, EveryVariationOfTheBoxCompiles) {
  using enum BoxVariation;
  const size_t walls = placed_triangles(closed_box().scene);
  for (BoxVariation variation : {point_light, directional_light, triangles_80k, reflective, glass}) {
    ExperimentScene box = closed_box(variation);
    validate(box.scene, box.name);
    const size_t triangles = placed_triangles(box.scene);
    const CompiledScene compiled(std::move(box.scene), {});
    EXPECT_GT(compiled.view().lights.lights.size, 0u) << box.name;
    EXPECT_GT(triangles, variation == triangles_80k ? walls + 80000 : 0) << box.name;
  }
}

TEST(ExperimentScenes, BoxesUnderALightWithoutExtentHaveThatLightAlone) {
  for (const DeltaLight light : {DeltaLight::point, DeltaLight::directional}) {
    for (const char* name : {"cornell-spheres", "cornell-mirror", "cornell-water"}) {
      ExperimentScene box = box_under(name, light, 4);
      validate(box.scene, box.name);
      EXPECT_EQ(box.settings.path.max_bounces, 4) << box.name;
      const CompiledScene compiled(std::move(box.scene), {});
      const View<const Light> lights = compiled.view().lights.lights;
      ASSERT_EQ(lights.size, 1u) << box.name;
      EXPECT_EQ(lights[0].kind, light == DeltaLight::point ? LightKind::point : LightKind::directional) << box.name;
    }
  }
}

/// Power of all triangle lights in the green channel, in multiples of π.
double power_of(const CompiledScene& scene) {
  const View<const Light> lights = scene.view().lights.lights;
  double power = 0;
  for (const Light& light : lights) {
    if (light.kind != LightKind::triangle) continue;
    power += static_cast<double>(light.triangle.radiance.g) * static_cast<double>(light.triangle.area);
  }
  return power;
}

TEST(ExperimentScenes, ALargeLampHasThePowerOfTheSmallOne) {
  for (const char* name : {"cornell-water", "cornell-glass"}) {
    ExperimentScene large = box_under_large_lamp(name, 30, 8);
    validate(large.scene, large.name);
    EXPECT_EQ(large.name, std::string(name) + ", large lamp");
    const CompiledScene after(std::move(large.scene), {});
    const CompiledScene before(built_in(name, 8).scene, {});
    EXPECT_NEAR(power_of(after) / power_of(before), 1, 1e-4) << name;
  }
}

TEST(ExperimentScenes, TurnsKeepThePlace) {
  const ExperimentScene box = closed_box();
  const auto quarter = turned(box, 90);
  EXPECT_EQ(quarter->to_world[3], box.camera->to_world[3]);
  const Vec3 before(box.camera->to_world[2]);
  const Vec3 after(quarter->to_world[2]);
  EXPECT_NEAR(after.y, before.y, 1e-6f);
  EXPECT_NEAR(before.x * after.x + before.z * after.z, 0, 1e-6f);
}

TEST(ExperimentScenes, SidewaysMotionIsTheSameInAnyViewDirection) {
  const ExperimentScene box = closed_box();
  EXPECT_EQ(turned_aside(box, 30, 0)->to_world, turned(box, 30)->to_world);
  for (const float degrees : {0.0f, 90.0f}) {
    const auto camera = turned_aside(box, degrees, 0.25f);
    EXPECT_EQ(camera->to_world[0], turned(box, degrees)->to_world[0]);
    const Vec3 way = Vec3(camera->to_world[3]) - Vec3(box.camera->to_world[3]);
    EXPECT_NEAR(glm::dot(way, Vec3(box.camera->to_world[0])), 0.25f, 1e-6f);
    EXPECT_NEAR(length_squared(way), 0.0625f, 1e-6f);
  }
}

TEST(ExperimentScenes, WalksLeadAlongTheUnturnedView) {
  const ExperimentScene box = closed_box();
  for (const float degrees : {0.0f, 30.0f}) {
    const auto camera = turned_ahead(box, degrees, 0.25f);
    EXPECT_EQ(camera->to_world[2], turned(box, degrees)->to_world[2]);
    const Vec3 way = Vec3(camera->to_world[3]) - Vec3(box.camera->to_world[3]);
    EXPECT_NEAR(glm::dot(way, Vec3(box.camera->to_world[2])), -0.25f, 1e-6f);
    EXPECT_NEAR(length_squared(way), 0.0625f, 1e-6f);
  }
}

}  // namespace
}  // namespace relume
