#include "scene/view_lighting.h"

#include <gtest/gtest.h>

#include "scene/compiled_scene.h"
#include "scene/testing/plate.h"

namespace relume {
namespace {

/// A plate that a camera faces, under a constant environment and a point light at (0, 0, ±1).
ViewLighting lighting_of(float radiance, float intensity, bool covered = false) {
  Scene scene = testing::plate();
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = Rgb(radiance);
  scene.lights.push_back({.name = "lamp", .type = PunctualType::point, .intensity = Rgb(intensity)});
  Node node;
  node.light = 0;
  node.transform.translation = {0, 0, covered ? -1 : 1};
  scene.add_node(node);
  const CompiledScene compiled(scene, {.width = 16, .height = 16});
  return estimate_view_lighting(compiled.view());
}

TEST(ViewLighting, AddsUpIrradiance) {
  const ViewLighting sky = lighting_of(1, 0);
  EXPECT_EQ(sky.finite, 0.0f);
  EXPECT_NEAR(lighting_of(3, 0).infinite, 3 * sky.infinite, 1e-3f * sky.infinite);
  const ViewLighting lamp = lighting_of(0, 2);
  EXPECT_EQ(lamp.infinite, 0.0f);
  EXPECT_GT(lamp.finite, 0.0f);
  EXPECT_EQ(lighting_of(0, 2, true).finite, 0.0f) << "behind the plate";
}

TEST(ViewLighting, ComparesPixelByPixel) {
  EXPECT_FALSE(lighting_of(1, 1e-4f).finite_lights_give(0.02f));
  EXPECT_TRUE(lighting_of(1, 10).finite_lights_give(0.5f));
  EXPECT_TRUE(lighting_of(0, 1e-4f).finite_lights_give(0.5f)) << "nothing comes from infinity";
  const ViewLighting bright = lighting_of(1, 1e6f);
  EXPECT_LE(bright.comparable, bright.infinite);
}

}  // namespace
}  // namespace relume
