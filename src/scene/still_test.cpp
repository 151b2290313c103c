#include "scene/still.h"

#include <gtest/gtest.h>

#include "scene/compiled_scene.h"
#include "scene/testing/figure.h"
#include "scene/world_triangles.h"

namespace relume {
namespace {

std::vector<Vec3> world_corners(const Scene& scene, float time_s) {
  CompiledScene compiled(scene, {.width = 16, .height = 16});
  compiled.set_time(time_s);
  std::vector<Vec3> corners;
  for_each_world_triangle(compiled.view(), [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    for (const Vec3& corner : {a, b, c}) corners.push_back(corner);
  });
  return corners;
}

/// Expects the triangles of the moving scene at that time, and no animation.
void expect_still(const Scene& moving, float time_s) {
  const Scene still = still_scene(moving, time_s);
  EXPECT_TRUE(still.animation.empty() && still.parameter_animation.empty() && still.skins.empty());
  const std::vector<Vec3> expected = world_corners(moving, time_s);
  const std::vector<Vec3> found = world_corners(still, 0);
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i) EXPECT_LT(glm::length(found[i] - expected[i]), 1e-5f) << i;
}

TEST(StillScene, FiguresHaveTheirPose) {
  for (const float time_s : {0.0f, 0.4f}) {
    expect_still(testing::figure(), time_s);
    expect_still(testing::figure({.morphs = true}), time_s);
    expect_still(testing::figure({.morphs = true, .skinned = false}), time_s);
    expect_still(testing::figure({.morphs = true, .parts = 2}), time_s);
  }
}

TEST(StillScene, SkinsIgnoreTheTransformOfTheirNode) {
  Scene scene = testing::figure();
  scene.nodes[0].transform.translation = {1, 2, 3};
  expect_still(scene, 0.4f);
}

TEST(StillScene, NodesAndParametersHaveTheirValues) {
  Scene scene = testing::figure({.skinned = false});
  Node child = scene.nodes[0];
  child.parent = 0;
  scene.add_node(child);
  scene.animation = {{0, AnimatedProperty::translation, Interpolation::linear, {0, 1}, {Vec4(0), Vec4(2)}, 0, 0},
                     {1, AnimatedProperty::visible, Interpolation::step, {0, 1}, {Vec4(1), Vec4(0)}, 0, 0}};
  scene.parameter_animation = {
      {AnimatedPart::material, 0, "roughness", Interpolation::linear, {0, 1}, {Vec4(0), Vec4(1)}, 0}};
  expect_still(scene, 0.25f);
  expect_still(scene, 1);
  const Scene still = still_scene(scene, 0.25f);
  EXPECT_FLOAT_EQ(still.materials[0].roughness, 0.25f);
  EXPECT_TRUE(still.nodes[1].visible);
  EXPECT_FALSE(still_scene(scene, 1).nodes[1].visible);
}

TEST(StillScene, OnlyTheFirstClipPlays) {
  Scene scene = testing::figure({.skinned = false});
  scene.clips = {"right", "left"};
  scene.animation = {{0, AnimatedProperty::translation, Interpolation::linear, {0}, {Vec4(-1)}, 0, 1},
                     {0, AnimatedProperty::translation, Interpolation::linear, {0}, {Vec4(1)}, 0, 0}};
  EXPECT_EQ(still_scene(scene, 0).nodes[0].transform.translation, Vec3(1));
}

}  // namespace
}  // namespace relume
