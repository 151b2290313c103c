// Surface points: interpolation, ray origins off their surface, and equality of instances and copies.
#include "scene/surface_point.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "scene/compiled_scene.h"
#include "scene/testing/textured_square.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::checkered;
using testing::one_texel;
using testing::Random;
using testing::TexturedSquare;

/// A bumpy patch with every attribute.
Mesh patch(Random& random) {
  constexpr uint32_t kSide = 6;
  Mesh m;
  for (uint32_t j = 0; j < kSide; ++j) {
    for (uint32_t i = 0; i < kSide; ++i) {
      const Vec2 uv(static_cast<float>(i) / (kSide - 1), static_cast<float>(j) / (kSide - 1));
      m.positions.emplace_back(uv.x - 0.5f, 0.2f * random.next(), uv.y - 0.5f);
      m.normals.push_back(glm::normalize(Vec3(0.3f * random.next(), 1, 0.3f * random.next())));
      m.tangents.emplace_back(1, 0, 0, 1);
      m.uv0.push_back(uv);
      m.colors.emplace_back(random.next(), random.next(), random.next(), 1);
    }
  }
  for (uint32_t j = 0; j + 1 < kSide; ++j) {
    for (uint32_t i = 0; i + 1 < kSide; ++i) {
      const uint32_t a = j * kSide + i;
      m.triangles.emplace_back(a, a + kSide, a + 1);
      m.triangles.emplace_back(a + 1, a + kSide, a + kSide + 1);
    }
  }
  m.material = 0;
  return m;
}

/// One patch transformed by `matrix`. `moving`: through an instance of the acceleration structure, since animated nodes
/// are not flattened.
std::unique_ptr<CompiledScene> patch_under(const Mat4& matrix, bool moving) {
  Random random(101);
  Scene scene;
  scene.name = "patch";
  Material material;
  material.metallic = 0;
  scene.materials.push_back(material);
  scene.meshes.push_back(patch(random));
  Node parent;
  parent.matrix = matrix;
  scene.add_node(parent);
  Node child;
  child.parent = 0;
  child.meshes.push_back(0);
  scene.add_node(child);
  if (moving)
    scene.animation.push_back({1, AnimatedProperty::translation, Interpolation::step, {0, 1}, {Vec4(0), Vec4(0)}});
  return std::make_unique<CompiledScene>(std::move(scene), CompileOptions{.camera = {}, .width = 16, .height = 16});
}

std::vector<Mat4> transforms() {
  const Mat4 one(1);
  const Mat4 turned = glm::rotate(one, 0.7f, glm::normalize(Vec3(1, 2, 3)));
  return {one,
          glm::translate(one, Vec3(5, -3, 2)) * turned,
          glm::scale(one, Vec3(2, 0.5f, 1.5f)) * turned,
          glm::scale(one, Vec3(-1, 1, 1)),                                                   // mirrored
          glm::translate(one, Vec3(1, 2, 3)) * glm::scale(one, Vec3(1, -2, 0.7f)) * turned,  // mirrored and stretched
          glm::scale(one, Vec3(-1, -1, -1)) * turned};
}

TEST(SurfacePoint, InstancesLookLikeCopies) {
  for (const Mat4& matrix : transforms()) {
    const auto flat = patch_under(matrix, false);
    const auto instanced = patch_under(matrix, true);
    ASSERT_TRUE(flat->view().instances[0].in_world_space);
    ASSERT_FALSE(instanced->view().instances[0].in_world_space);
    Random random(102);
    const bool stretched = std::fabs(glm::length(matrix[0]) - glm::length(matrix[1])) > 1e-3f;
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 target = transform_point(matrix, random.point(0.45f) * Vec3(1, 0.1f, 1));
      const Ray ray{target - random.direction() * 3.0f, Vec3(0), kInfinity};
      const Ray towards{ray.origin, glm::normalize(target - ray.origin), kInfinity};
      const Hit a = intersect(flat->view().accel, towards, 0);
      const Hit b = intersect(instanced->view().accel, towards, 0);
      // At an edge, one of the rays may hit the neighbour or miss.
      if (!a.valid() || !b.valid() || a.primitive != b.primitive) continue;
      ++hits;
      SurfacePoint p;
      SurfacePoint q;
      make_surface_point(flat->view(), towards, a, 0.01f, p);
      make_surface_point(instanced->view(), towards, b, 0.01f, q);
      ASSERT_LT(glm::length(p.position - q.position), 2e-5f);
      ASSERT_LT(glm::length(p.position - (towards.origin + towards.direction * a.t)), 2e-5f);
      ASSERT_EQ(p.front_face, q.front_face);
      ASSERT_LT(glm::length(p.ng - q.ng), 1e-4f);
      // Normals are quantised before or after the transform. A stretched instance also interpolates them before it, a
      // copy after it.
      ASSERT_LT(glm::length(p.frame.n - q.frame.n), stretched ? 4e-2f : 1e-3f);
      ASSERT_LT(max_component(abs(albedo(p.bsdf, 0.5f) - albedo(q.bsdf, 0.5f))), 1e-3f);
      ASSERT_GE(glm::dot(p.ng, p.wo), 0.0f);
      ASSERT_GT(glm::dot(p.frame.n, p.wo), 0.0f);
    }
    EXPECT_GT(hits, 300);
  }
}

TEST(SurfacePoint, FrontFacesAreThoseOfTheAuthor) {
  // Counter-clockwise seen from +Y. A mirrored copy is still seen from its front, as glTF requires.
  for (const Mat4& matrix : transforms()) {
    for (const bool moving : {false, true}) {
      const auto scene = patch_under(matrix, moving);
      const Mat3 normal_matrix = glm::transpose(glm::inverse(Mat3(matrix)));
      const Vec3 up = glm::normalize(normal_matrix * Vec3(0, 1, 0));
      const Vec3 centre = transform_point(matrix, Vec3(0.03f, 0.1f, 0.04f));
      const Ray from_above{centre + up * 3.0f, -up, kInfinity};
      const Hit hit = intersect(scene->view().accel, from_above, 0);
      ASSERT_TRUE(hit.valid());
      SurfacePoint sp;
      make_surface_point(scene->view(), from_above, hit, 0, sp);
      EXPECT_TRUE(sp.front_face) << moving;
      const Ray from_below{centre - up * 3.0f, up, kInfinity};
      const Hit back = intersect(scene->view().accel, from_below, 0);
      ASSERT_TRUE(back.valid());
      make_surface_point(scene->view(), from_below, back, 0, sp);
      EXPECT_FALSE(sp.front_face) << moving;
    }
  }
}

/// Random triangles of one size around one position.
std::unique_ptr<CompiledScene> triangles_at(const Vec3& place, float size, bool moving) {
  Random random(103);
  Scene scene;
  scene.name = "triangles";
  scene.materials.emplace_back();
  for (int k = 0; k < 50; ++k) {
    Mesh m;
    // Far apart: a second hit is always on the same triangle.
    const Vec3 centre =
        Vec3(static_cast<float>(k % 10), static_cast<float>(k / 10), 0.0f) * (4.0f * size) + (moving ? Vec3(0) : place);
    for (int v = 0; v < 3; ++v) m.positions.push_back(centre + random.point(size));
    m.triangles = {{0, 1, 2}};
    m.material = 0;
    scene.meshes.push_back(m);
    Node node;
    node.meshes = {k};
    node.transform.translation = moving ? place : Vec3(0);
    node.transform.rotation = moving ? glm::angleAxis(0.3f, glm::normalize(Vec3(1, 1, 0))) : glm::quat(1, 0, 0, 0);
    const Index index = scene.add_node(node);
    if (moving)
      scene.animation.push_back({index, AnimatedProperty::scale, Interpolation::step, {0, 1}, {Vec4(1), Vec4(1)}});
  }
  return std::make_unique<CompiledScene>(std::move(scene), CompileOptions{.camera = {}, .width = 16, .height = 16});
}

TEST(SurfacePoint, RaysLeaveTheirSurface) {
  for (const bool moving : {false, true}) {
    for (const auto& [place, size] : std::vector<std::pair<Vec3, float>>{{Vec3(0), 1.0f},
                                                                         {Vec3(0), 1e-3f},
                                                                         {Vec3(0), 1e3f},
                                                                         {Vec3(100, -50, 30), 1.0f},
                                                                         {Vec3(1e4f, 2e4f, -1e4f), 10.0f},
                                                                         {Vec3(1000, 0, 500), 0.05f}}) {
      const auto scene = triangles_at(place, size, moving);
      Random random(104);
      int spawned = 0;
      for (int i = 0; i < 3000; ++i) {
        // A point on a random triangle, seen from a random side.
        const auto k = static_cast<uint32_t>(random.next() * 50);
        const SceneView& view = scene->view();
        const Vec2 b = triangle_from_square(random.next_2d());
        Hit hit;
        hit.instance = k;
        hit.u = b.x;
        hit.v = b.y;
        hit.t = 1;
        SurfacePoint sp;
        make_surface_point(view, Ray{Vec3(0), random.direction(), kInfinity}, hit, 0, sp);
        const Vec3 w = random.direction();
        if (std::fabs(glm::dot(w, sp.ng)) < 0.01f) continue;  // along the surface, any rounding causes a hit
        const Hit again = intersect(view.accel, sp.spawn_ray(w), 0);
        ASSERT_FALSE(again.valid() && again.instance == k)
            << "size " << size << ", moving " << moving << ", t " << again.t;
        ++spawned;
      }
      EXPECT_GT(spawned, 2000);
    }
  }
}

TEST(SurfacePoint, MotionUsesThePreviousPosition) {
  Random random(105);
  Scene scene;
  scene.name = "moving";
  scene.materials.emplace_back();
  scene.meshes.push_back(patch(random));
  Node node;
  node.meshes = {0};
  scene.add_node(node);
  scene.animation.push_back(
      {0, AnimatedProperty::translation, Interpolation::linear, {0, 1}, {Vec4(0), Vec4(2, 0, 0, 0)}});
  CompiledScene compiled(std::move(scene), CompileOptions{.camera = {}, .width = 16, .height = 16});
  compiled.set_time(0.25f);
  const Ray down{Vec3(0.5f + 0.13f, 3, 0.07f), Vec3(0, -1, 0), kInfinity};
  const Hit hit = intersect(compiled.view().accel, down, 0);
  ASSERT_TRUE(hit.valid());
  SurfacePoint sp;
  make_surface_point(compiled.view(), down, hit, 0, sp);
  EXPECT_NEAR(sp.position.x - sp.previous_position.x, 0.5f, 1e-5f);
  EXPECT_NEAR(sp.position.y, sp.previous_position.y, 1e-6f);
}

TEST(SurfacePoint, TextureLevelsFollowTheSetInUse) {
  // The other set repeats 2000 times: its footprint would select the coarsest level, which is grey.
  for (const int used : {0, 1}) {
    TexturedSquare square(checkered(64));
    square.material().unlit = true;
    square.material().base_color_texture = {.texture = 0, .uv_set = used};
    square.mesh().uv0 = TexturedSquare::uv(used == 0 ? 1.0f : 2000.0f);
    square.mesh().uv1 = TexturedSquare::uv(used == 1 ? 1.0f : 2000.0f);
    EXPECT_EQ(square.seen_at({-0.5f, 0.5f}, 1e-3f).emission, Rgb(1)) << used;
    EXPECT_EQ(square.seen_at({0.5f, 0.5f}, 1e-3f).emission, Rgb(0)) << used;
  }
}

TEST(SurfacePoint, DerivedTangentsFollowTheCoordinatesInUse) {
  TexturedSquare square(one_texel({204, 128, 230, 255}));  // tilts every normal towards growing u
  square.mesh().uv0 = TexturedSquare::uv(1);
  square.material().normal_texture.texture = 0;
  const Vec3 tilted = square.seen_at({0.3f, 0.4f}, 0).frame.n;
  ASSERT_GT(tilted.x, 0.5f);  // u grows along +X
  const auto normal = [&] { return square.seen_at({0.3f, 0.4f}, 0).frame.n; };

  // A quarter turn: u' = v, v' = −u. u' grows where v does, along −Y.
  square.material().normal_texture.rotation_rad = kPi / 2;
  EXPECT_LT(glm::length(normal() - Vec3(tilted.y, -tilted.x, tilted.z)), 1e-4f);
  square.material().normal_texture.rotation_rad = 0;
  square.material().normal_texture.scale = Vec2(-1, 1);  // mirrored
  EXPECT_LT(glm::length(normal() - Vec3(-tilted.x, tilted.y, tilted.z)), 1e-4f);

  square.material().normal_texture = {.texture = 0, .uv_set = 1};
  square.mesh().uv1 = {Vec2(1, 1), Vec2(1, 0), Vec2(0, 0), Vec2(0, 1)};  // u grows along −Y, v along −X
  EXPECT_LT(glm::length(normal() - Vec3(tilted.y, -tilted.x, tilted.z)), 1e-4f);
  square.mesh().uv0.clear();
  EXPECT_LT(glm::length(normal() - Vec3(tilted.y, -tilted.x, tilted.z)), 1e-4f);
}

}  // namespace
}  // namespace relume
