#include "scene/ray_queries.h"

#include <gtest/gtest.h>

#include "accel/testing/scene_rays.h"
#include "scene/testing/textured_square.h"

namespace relume {
namespace {

using testing::Random;

constexpr float kReach = 1.2f;  // some rays miss the squares

/// An alpha channel of random values.
Texture random_alpha(Random& random) {
  Texture t;
  t.name = "alpha";
  t.width = t.height = 8;
  t.format = PixelFormat::rgba8_linear;
  for (int i = 0; i < t.width * t.height; ++i) {
    for (const uint32_t code : {255u, 255u, 255u, random.bits() % 256})
      t.texels.push_back(static_cast<std::byte>(code));
  }
  return t;
}

/// Squares behind each other: opaque, blended and masked, with textures and colours, some culled, mirrored or movable.
Scene layers_of_squares(Random& random, std::vector<Index>& movable) {
  testing::TexturedSquare square(random_alpha(random));
  Scene scene = square.scene;
  scene.meshes[0].uv0 = testing::TexturedSquare::uv(1);
  scene.meshes[0].uv1 = testing::TexturedSquare::uv(2.5f);
  for (int i = 1; i < 12; ++i) {
    Mesh mesh = scene.meshes[0];
    Material material;
    material.alpha_mode = i == 11 ? AlphaMode::opaque : (i % 2 ? AlphaMode::blend : AlphaMode::mask);
    material.alpha = random.uniform(0.5f, 1);
    if (i % 3) material.base_color_texture = {.texture = 0, .uv_set = i % 2, .rotation_rad = random.uniform()};
    if (i % 4 == 0) mesh.colors = {Vec4(1), Vec4(1, 1, 1, 0), Vec4(1), Vec4(1, 1, 1, 0.5f)};
    material.cull_back_faces = i % 5 == 0;
    mesh.material = static_cast<Index>(scene.materials.size());
    scene.materials.push_back(material);
    Node node;
    node.meshes = {static_cast<Index>(scene.meshes.size())};
    scene.meshes.push_back(mesh);
    node.transform.translation = Vec3(random.uniform(-0.2f, 0.2f), 0, -0.1f * static_cast<float>(i));
    node.transform.scale = Vec3(i % 3 == 1 ? -1 : 1, 1, 1);
    const Index index = scene.add_node(node);
    if (i % 2) movable.push_back(index);
  }
  scene.materials[0].alpha_mode = AlphaMode::blend;
  scene.materials[0].base_color_texture.texture = 0;
  return scene;
}

void expect_equal(const Hit& hit, const Hit& expected) {
  ASSERT_EQ(hit.instance, expected.instance);
  ASSERT_EQ(hit.primitive, expected.primitive);
  ASSERT_EQ(hit.u, expected.u);
  ASSERT_EQ(hit.v, expected.v);
  ASSERT_EQ(hit.t, expected.t);
}

/// A kernel's queries, and those of device code, against the host's.
void compare_queries(const SceneView& scene, const Ray& ray, uint32_t id) {
  const Hit nearest = intersect(scene.accel, ray, id);
  const Hit seen = intersect_from_camera(scene.accel, ray, id);
  const bool blocked = occluded(scene.accel, ray, id);
  const bool blocked_to_camera = occluded_to_camera(scene.accel, ray, id);
  ASSERT_NO_FATAL_FAILURE(expect_equal(intersect(scene, ray, id), nearest));
  ASSERT_NO_FATAL_FAILURE(expect_equal(intersect_from_camera(scene, ray, id), seen));
  ASSERT_EQ(occluded(scene, ray, id), blocked);
  ASSERT_EQ(occluded_to_camera(scene, ray, id), blocked_to_camera);
  ASSERT_NO_FATAL_FAILURE(expect_equal(traverse_to_nearest(scene, ray, id, 0), nearest));
  ASSERT_NO_FATAL_FAILURE(expect_equal(traverse_to_nearest(scene, ray, id, kFromCamera), seen));
  ASSERT_EQ(traverse_to_any(scene, ray, id, 0), blocked);
  ASSERT_EQ(traverse_to_any(scene, ray, id, kToCamera), blocked_to_camera);
}

TEST(RayQueries, DeviceCodeEvaluatesOpacityAndSidesLikeTheHost) {
  Random random(1);
  std::vector<Index> movable;
  const Scene squares = layers_of_squares(random, movable);
  const CompiledScene compiled(squares, {.movable = movable, .accel = AccelChoice::bvh});
  const SceneView& scene = compiled.view();
  std::vector<uint32_t> hits(scene.instances.size);
  for (uint32_t i = 0; i < 20000; ++i) {
    const Vec3 origin(random.uniform(-kReach, kReach), random.uniform(-kReach, kReach), random.uniform(-1.5f, 0.5f));
    const Vec3 target(random.uniform(-kReach, kReach), random.uniform(-kReach, kReach), i % 2 ? 1.0f : -2.0f);
    const Ray ray{origin, glm::normalize(target - origin), i % 3 ? kInfinity : random.uniform(1, 5)};
    ASSERT_NO_FATAL_FAILURE(compare_queries(scene, ray, i)) << i;
    const Hit hit = intersect_from_camera(scene, ray, i);
    if (hit.valid()) ++hits[hit.instance];
  }
  for (const uint32_t count : hits) EXPECT_GT(count, 0u);
}

TEST(RayQueries, RaysMissAnEmptyStructure) {
  const SceneView scene{};
  const Ray ray{Vec3(0), Vec3(0, 0, 1), kInfinity};
  EXPECT_FALSE(traverse_to_nearest(scene, ray, 0, 0).valid());
  EXPECT_FALSE(traverse_to_any(scene, ray, 0, 0));
}

}  // namespace
}  // namespace relume
