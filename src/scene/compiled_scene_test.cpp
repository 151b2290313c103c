#include "scene/compiled_scene.h"

#include <gtest/gtest.h>

#include "scene/testing/light_scene.h"

namespace relume {
namespace {

/// A plane whose material takes its colour from texture 0 as `ref` says.
CompiledScene textured_plane(const TextureRef& ref) {
  Scene scene;
  scene.textures.push_back(testing::noise_texture(4));
  Material material;
  material.emission = Rgb(1);
  material.base_color_texture = ref;
  scene.materials.push_back(material);
  scene.meshes.push_back(testing::emissive_triangle(0, 0));
  Node node;
  node.meshes = {0};
  scene.add_node(node);
  return {std::move(scene), CompileOptions{}};
}

void expect_near(const Vec2& a, const Vec2& b) {
  EXPECT_NEAR(a.x, b.x, 1e-6f);
  EXPECT_NEAR(a.y, b.y, 1e-6f);
}

TEST(CompiledScene, TexturesTurnAsTheirExtensionSays) {
  // The example in the text of KHR_texture_transform: "only the lower left quadrant of the source image, rotated
  // clockwise 90°". V points down. (The GLSL listing there turns the other way; KhronosGroup/glTF issue 1563.)
  TextureRef ref;
  ref.texture = 0;
  ref.offset = {0, 1};
  ref.rotation_rad = 0.5f * kPi;
  ref.scale = {0.5f, 0.5f};
  const CompiledScene scene = textured_plane(ref);
  const UvTransform& transform = scene.view().materials[0].base_color_texture.transform;
  expect_near(transform({0, 0}), {0, 1});        // upper left of the surface: lower left of the image
  expect_near(transform({1, 0}), {0, 0.5f});     // upper right: the image's left edge, half way up
  expect_near(transform({0, 1}), {0.5f, 1});     // lower left: half way along the lower edge
  expect_near(transform({1, 1}), {0.5f, 0.5f});  // the centre
}

TEST(CompiledScene, TexturesAreScaledBeforeTheyAreTurned) {
  TextureRef ref;
  ref.texture = 0;
  ref.rotation_rad = 0.5f * kPi;
  ref.scale = {2, 3};
  const CompiledScene scene = textured_plane(ref);
  expect_near(scene.view().materials[0].base_color_texture.transform({1, 1}), {3, -2});
}

TEST(CompiledScene, MovingInstancesOfATexturedEmitterShareItsTable) {
  Scene scene;
  scene.textures.push_back(testing::noise_texture(16));
  Material material;
  material.emission = Rgb(3);
  material.emission_texture.texture = 0;
  scene.materials.push_back(material);
  scene.meshes.push_back(testing::emissive_triangle(0, 0));
  for (int i = 0; i < 3; ++i) {
    Node node;
    node.meshes = {0};
    const Index index = scene.add_node(node);
    const Vec4 start(2 * i, 0, 0, 0);
    scene.animation.push_back({index, AnimatedProperty::translation, Interpolation::linear, {0, 2}, {start, Vec4(9)}});
  }
  CompiledScene compiled(std::move(scene), CompileOptions{});
  for (const float time_s : {0.0f, 1.0f, 2.0f}) {
    compiled.set_time(time_s);
    const LightsView& lights = compiled.view().lights;
    ASSERT_EQ(lights.lights.size, 3u);
    EXPECT_EQ(lights.textured.triangles.size, 1u);
    for (LightId id = 0; id < 3; ++id) EXPECT_EQ(lights.lights[id].triangle.textured, 0);
  }
}

}  // namespace
}  // namespace relume
