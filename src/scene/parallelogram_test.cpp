#include "scene/parallelogram.h"

#include <gtest/gtest.h>

#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "scene/surface_point.h"
#include "scene/testing/plate.h"

namespace relume {
namespace {

/// Vertices at the corners of a parallelogram, and one beside it.
std::vector<Vertex> corners() {
  std::vector<Vertex> vertices;
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(5, 2, 1), Vec3(1, 2, 1), Vec3(1.5f, 2, 1)})
    vertices.push_back({p, {}, {}, 0});
  return vertices;
}

std::optional<Parallelogram> found(const UVec3& a, const UVec3& b) {
  const std::vector<Vertex> vertices = corners();
  return find_parallelogram(view_of(vertices), a, b);
}

TEST(Parallelogram, KeepsTheOrderOfTheFirstTriangle) {
  for (const UVec3& second : {UVec3(0, 2, 3), UVec3(2, 3, 0), UVec3(3, 0, 2)}) {
    const auto p = found({0, 1, 2}, second);
    ASSERT_TRUE(p);
    EXPECT_EQ(p->corner, 1u);
    EXPECT_EQ(p->first_end, 2u);
    EXPECT_EQ(p->second_end, 0u);
    EXPECT_EQ(p->deviation, 0.0f);
  }
}

TEST(Parallelogram, RefusesOtherPairs) {
  EXPECT_FALSE(found({0, 1, 2}, {0, 2, 4})) << "a trapezium";
  EXPECT_FALSE(found({0, 1, 2}, {0, 3, 2})) << "sides that face opposite directions";
  EXPECT_FALSE(found({0, 1, 2}, {0, 1, 2})) << "the same triangle";
  EXPECT_FALSE(found({0, 1, 1}, {1, 1, 0})) << "without area";
  EXPECT_FALSE(found({0, 1, 2}, {1, 3, 4})) << "without a common edge";
}

Scene glowing_plate() {
  Material material;
  material.emission = Rgb(2);
  return testing::plate(material);
}

const TriangleLight& only_light(const CompiledScene& scene) {
  EXPECT_EQ(scene.view().lights.lights.size, 1u);
  return scene.view().lights.lights[0].triangle;
}

TEST(Parallelogram, IsOneLightHoweverItIsPlaced) {
  for (const bool movable : {false, true}) {
    Scene scene = glowing_plate();
    scene.nodes[0].transform.translation = {3, 1, 2};
    scene.nodes[0].transform.scale = {-2, 1, 1};
    const CompiledScene compiled(scene,
                                 {.camera = {}, .movable = movable ? std::vector<Index>{0} : std::vector<Index>{}});
    const TriangleLight& light = only_light(compiled);
    EXPECT_TRUE(light.is_parallelogram);
    EXPECT_FLOAT_EQ(light.area, 8.0f);
    EXPECT_EQ(light.position(light.centre()), Vec3(3, 1, 2));
    // Hits on either triangle belong to it.
    for (const Vec2& at : {Vec2(1.5f, -0.5f), Vec2(-1.5f, 0.5f)}) {
      const Ray ray{{3 + at.x, 1 + at.y, 9}, {0, 0, -1}, kInfinity};
      SurfacePoint sp;
      const Hit hit = intersect(compiled.view().accel, ray, 0);
      ASSERT_TRUE(hit.valid());
      make_surface_point(compiled.view(), ray, hit, 0, sp);
      EXPECT_EQ(sp.light, 0u);
    }
  }
}

TEST(Parallelogram, TexturedLightsKeepTheirTriangles) {
  Scene scene = glowing_plate();
  Texture texture;
  texture.width = texture.height = 1;
  texture.texels.assign(4, std::byte{255});
  scene.textures.push_back(texture);
  scene.materials[0].emission_texture.texture = 0;
  scene.meshes[0].uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_EQ(CompiledScene(scene, {}).view().lights.lights.size, 2u);
}

TEST(Parallelogram, MeshesWithOtherTrianglesKeepThem) {
  Scene scene = glowing_plate();
  scene.meshes[0].positions.push_back({2, 2, 0});
  scene.meshes[0].triangles.push_back({1, 4, 2});
  EXPECT_EQ(CompiledScene(scene, {}).view().lights.lights.size, 3u);
}

}  // namespace
}  // namespace relume
