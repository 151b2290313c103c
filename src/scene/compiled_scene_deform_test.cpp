// Deforming meshes together with other parts of a scene.
#include <gtest/gtest.h>

#include <new>

#include "core/hash.h"
#include "scene/compiled_scene.h"
#include "scene/surface_point.h"
#include "scene/testing/expected_figure.h"
#include "scene/testing/plate.h"
#include "testing/failing_memory.h"

namespace relume {
namespace {

using testing::expected_joints;
using testing::figure;
using testing::problem_of;
using testing::stopped_figure;

CompileOptions small() { return {.width = 16, .height = 16}; }

TEST(DeformingMeshes, InstancesShareOneMesh) {
  for (const bool animated : {false, true}) {
    Scene scene =
        animated ? figure({.morphs = true, .skinned = false}) : stopped_figure({.morphs = true, .skinned = false});
    for (int i = 0; i < 3; ++i)
      scene.nodes[0].instances.push_back(glm::translate(Mat4(1), Vec3(static_cast<float>(i), 0, 0)));
    CompiledScene compiled(scene, small());
    EXPECT_EQ(compiled.view().instances.size, 3u);
    if (!animated) continue;
    EXPECT_EQ(compiled.view().vertices.size, scene.meshes[0].positions.size());
    compiled.set_time(1);
    for (uint32_t i = 0; i < 3; ++i) {
      const Ray ray{Vec3(static_cast<float>(i) - 0.38f, 1.99f, 0) + Vec3(0, 0, 3), Vec3(0, 0, -1), kInfinity};
      const Hit hit = intersect(compiled.view().accel, ray, 0);  // width 0.4 at the top, 0.2 at rest
      ASSERT_TRUE(hit.valid());
      EXPECT_EQ(hit.instance, i);
    }
  }
}

TEST(DeformingMeshes, OneMeshMayFollowSeveralSkinsAndNone) {
  Scene scene = figure();
  Skin second = scene.skins[0];
  for (Index& joint : second.joints) {
    Node copy = scene.nodes[static_cast<size_t>(joint)];
    copy.parent = &joint == &second.joints[0] ? kNone : static_cast<Index>(scene.nodes.size()) - 1;
    if (copy.parent == kNone) copy.transform.translation = Vec3(5, 0, 0);
    joint = scene.add_node(copy);
  }
  scene.skins.push_back(second);
  Node other = scene.nodes[0];
  other.skin = 1;
  scene.add_node(other);
  other.skin = kNone;
  other.transform.translation = Vec3(-5, 0, 0);
  scene.add_node(other);
  CompiledScene compiled(scene, small());
  const auto find = [&](const Vec3& from) {
    return intersect(compiled.view().accel, {from, Vec3(0, 0, -1), kInfinity}, 0);
  };
  compiled.set_time(1);
  EXPECT_FALSE(find(Vec3(0.05f, 1.95f, 3)).valid());  // bent away
  EXPECT_TRUE(find(Vec3(5.05f, 1.95f, 3)).valid());
  EXPECT_TRUE(find(Vec3(-4.95f, 1.95f, 3)).valid());
}

/// A figure whose top joint moves far off and back, which stretches the triangles below it.
Scene stretched_figure() {
  Scene scene = figure({.rings = 60, .segments = 40});
  std::erase_if(scene.animation, [](const AnimationChannel& c) { return c.node == 5; });
  scene.animation.push_back({5,
                             AnimatedProperty::translation,
                             Interpolation::linear,
                             {0, 1, 2},
                             {Vec4(0, 0.5f, 0, 0), Vec4(0, 40, 30, 0), Vec4(0, 0.5f, 0, 0)},
                             0,
                             0});
  return scene;
}

/// Compares the hits of rays across the figure.
void expect_same_hits(const CompiledScene& a, const CompiledScene& b) {
  for (uint32_t i = 0; i < 2000; ++i) {
    const Vec3 from(3 * to_unit_float(hash(i, 1u)) - 1.5f, 3 * to_unit_float(hash(i, 2u)), 4);
    const Vec3 to(2 * to_unit_float(hash(i, 3u)) - 1, 3 * to_unit_float(hash(i, 4u)), 0);
    const Ray ray{from, glm::normalize(to - from), kInfinity};
    const Hit hit_a = intersect_from_camera(a.view().accel, ray, i);
    const Hit hit_b = intersect_from_camera(b.view().accel, ray, i);
    ASSERT_EQ(hit_a.primitive, hit_b.primitive) << i;
    ASSERT_EQ(hit_a.t, hit_b.t);
  }
}

TEST(DeformingMeshes, TreesAreRebuiltWherePosesDiffer) {
  const Scene scene = stretched_figure();
  CompiledScene played(scene, small());
  for (const float time_s : {0.0f, 0.5f, 1.0f, 1.5f, 2.0f, 1.0f}) {
    played.set_time(time_s);
    played.end_frame();
    CompileOptions options = small();
    options.time_s = time_s;
    const CompiledScene alone(scene, options);
    expect_same_hits(played, alone);
  }
}

/// Fails each allocation of an update in turn, repeats the update, and compares the scene with one that never failed.
/// `update(scene)` returns the changes. `prepare(scene)`: precedes the first update and does not fail.
template <typename Update>
void expect_recovery(
    const Scene& source, const Update& update, void (*prepare)(CompiledScene&) = [](CompiledScene&) {}) {
  CompileOptions options = small();
  options.accel = AccelChoice::bvh;
  CompiledScene expected(source, options);
  prepare(expected);
  update(expected);
  int failures = 0;
  for (;; ++failures) {
    testing::FailingMemory memory;
    CompiledScene scene(source, options, memory);
    prepare(scene);
    memory.fail_after(failures);
    try {
      update(scene);
    } catch (const std::bad_alloc&) {
    }
    memory.recover();
    if (!memory.failed()) break;
    EXPECT_NE(update(scene), Change::none) << failures;
    expect_same_hits(scene, expected);
    EXPECT_EQ(scene.view().camera_medium, expected.view().camera_medium);
    EXPECT_EQ(update(scene) & Change::geometry, Change::none);
  }
  EXPECT_GT(failures, 0);
}

TEST(DeformingMeshes, ScenesRecoverFromUpdatesThatFailed) {
  expect_recovery(stretched_figure(), [](CompiledScene& scene) { return scene.set_time(1); });
  Material culled = stretched_figure().materials[0];
  culled.cull_back_faces = true;
  culled.emission = Rgb(1);
  expect_recovery(stretched_figure(), [&](CompiledScene& scene) { return scene.set_material(0, culled); });
}

TEST(DeformingMeshes, ScenesRecoverFromEditsThatFailed) {
  expect_recovery(
      figure(), [](CompiledScene& scene) { return scene.commit_edits(); },
      [](CompiledScene& scene) {
        Mesh wall;
        wall.positions = {{-1, 0, 1}, {1, 0, 1}, {0, 2, 1}};
        wall.triangles = {{0, 1, 2}};
        wall.material = 0;
        Node node;
        node.meshes = {scene.add_mesh(wall)};
        scene.add_node(node);
      });
}

TEST(DeformingMeshes, OpacityFollowsTheSurface) {
  Scene scene = figure();
  scene.materials[0].alpha_mode = AlphaMode::mask;
  scene.meshes[0].colors.assign(scene.meshes[0].positions.size(), Vec4(1));
  for (size_t v = 0; v < scene.meshes[0].positions.size(); ++v) {
    if (scene.meshes[0].positions[v].y > 1) scene.meshes[0].colors[v].w = 0;
  }
  CompiledScene compiled(scene, small());
  compiled.set_time(0.5f);
  int opaque = 0;
  for (uint32_t t = 0; t < compiled.view().triangles.size; ++t) {
    const UVec3 index = compiled.view().triangles[t];
    const View<const Vertex> v = compiled.view().vertices;
    const Vec3 n = glm::normalize(
        glm::cross(v[index.y].position - v[index.x].position, v[index.z].position - v[index.x].position));
    const Vec3 p = surface_position(compiled.view(), {0, t, 0.3f, 0.3f, 0}).now;
    const bool hit = intersect(compiled.view().accel, {p + 1e-3f * n, -n, 2e-3f}, 0).valid();
    EXPECT_EQ(hit, opacity(compiled.view(), 0, t, 0.3f, 0.3f) > 0) << t;
    opaque += hit;
  }
  EXPECT_NEAR(opaque, static_cast<int>(compiled.view().triangles.size) / 2, 40);
}

TEST(DeformingMeshes, LightsMoveWithTheSurface) {
  Scene scene = figure();
  scene.materials[0].emission = Rgb(1);
  CompiledScene compiled(scene, small());
  compiled.set_time(0.5f);
  compiled.end_frame();
  EXPECT_FALSE(compiled.view().lights.lights[100].changed);
  EXPECT_NE(compiled.set_time(1) & Change::lights, Change::none);
  const SceneView& view = compiled.view();
  EXPECT_TRUE(view.lights.lights[100].changed);
  for (uint32_t t = 0; t < view.triangles.size; ++t)
    EXPECT_EQ(view.lights.lights[t].triangle.v0, view.vertices[view.triangles[t].x].position);
}

TEST(DeformingMeshes, CamerasAndLightsMoveWithJoints) {
  Scene scene = figure();
  scene.cameras.emplace_back();
  scene.lights.emplace_back();
  scene.nodes[5].camera = 0;
  scene.nodes[5].light = 0;
  CompiledScene compiled(scene, small());
  compiled.set_time(1);
  const Vec3 expected(expected_joints({}, scene, 1)[4] * glm::dvec4(0, 2, 0, 1));
  EXPECT_LT(glm::length(compiled.view().camera.position - expected), 1e-5f);
  EXPECT_LT(glm::length(compiled.view().lights.lights[0].point.position - expected), 1e-5f);
}

TEST(DeformingMeshes, RemovedFiguresNoLongerMove) {
  CompiledScene compiled(figure(), small());
  EXPECT_NE(problem_of([&] { compiled.remove_node(3); }).find("is a joint of node 'body'; remove that first"),
            std::string::npos);
  compiled.remove_node(0);
  compiled.commit_edits();
  compiled.end_frame();
  EXPECT_EQ(compiled.set_time(0.7f), Change::none);
  compiled.remove_node(3);
}

TEST(DeformingMeshes, RejectsJointsBeyondTheLimitAtOnce) {
  for (const bool still : {false, true}) {
    Scene scene = still ? stopped_figure({}) : figure();
    scene.nodes[1].transform.scale = Vec3(1e30f);
    scene.nodes[2].transform.scale = Vec3(1e30f);
    EXPECT_NE(problem_of([&] { CompiledScene(scene, small()); }).find("joint 'joint 0' is moved or scaled beyond"),
              std::string::npos);
  }
}

TEST(DeformingMeshes, FollowJointsThatArePlacedByHand) {
  Scene scene = figure();
  scene.animation.clear();
  CompileOptions options = small();
  options.movable = {1};
  CompiledScene compiled(scene, options);
  const Vec3 before = compiled.view().vertices[0].position;
  EXPECT_NE(compiled.set_transform(1, {.translation = Vec3(1, 2, 3)}) & Change::geometry, Change::none);
  EXPECT_LT(glm::length(compiled.view().vertices[0].position - before - Vec3(1, 2, 3)), 1e-6f);
  EXPECT_NE(problem_of([&] { compiled.set_transform(1, {.translation = Vec3(1e20f)}); }).find("joint 'joint 0'"),
            std::string::npos);
  EXPECT_LT(glm::length(compiled.view().vertices[0].position - before - Vec3(1, 2, 3)), 1e-6f);
}

TEST(DeformingMeshes, MirroredSkinsTurnTheirFrontOutwards) {
  Scene scene = figure();
  scene.nodes[1].transform.scale = Vec3(-1, 1, 1);
  const CompiledScene compiled(scene, small());
  EXPECT_EQ(compiled.view().instances[0].orientation, -1.0f);
  SurfacePoint sp;
  const Hit hit = intersect(compiled.view().accel, {Vec3(0.05f, 0.5f, 3), Vec3(0, 0, -1), kInfinity}, 0);
  ASSERT_TRUE(hit.valid());
  make_surface_point(compiled.view(), {Vec3(0.05f, 0.5f, 3), Vec3(0, 0, -1), kInfinity}, hit, 0, sp);
  EXPECT_TRUE(sp.front_face);
  EXPECT_GT(sp.ns.z, 0.5f);
}

TEST(DeformingMeshes, HiddenLightsLightNothing) {
  Scene scene = figure();
  scene.environment.kind = EnvironmentKind::automatic;
  scene.lights.emplace_back();
  scene.nodes[5].light = 0;
  EXPECT_FALSE(CompiledScene(scene, small()).in_studio());
  scene.nodes[5].visible = false;
  EXPECT_TRUE(CompiledScene(scene, small()).in_studio());
}

void expect_hidden_nodes_are_invisible(AccelChoice accel) {
  CompileOptions options = small();
  options.accel = accel;
  for (const bool skinned : {false, true}) {
    Scene scene = figure({.skinned = skinned});
    scene.materials[0].emission = Rgb(1);
    scene.animation.push_back({0, AnimatedProperty::visible, Interpolation::step, {0, 0.5f}, {Vec4(0), Vec4(1)}, 0, 0});
    CompiledScene compiled(scene, options);
    const Ray ray{Vec3(0.05f, 0.05f, 3), Vec3(0, 0, -1), kInfinity};
    const auto shines = [&] { return !is_black(compiled.view().lights.lights[0].triangle.radiance); };
    EXPECT_FALSE(intersect(compiled.view().accel, ray, 0).valid());
    EXPECT_FALSE(shines());
    EXPECT_NE(compiled.set_time(0.5f), Change::none);
    EXPECT_TRUE(intersect(compiled.view().accel, ray, 0).valid());
    EXPECT_TRUE(shines());
    compiled.set_time(0);
    EXPECT_FALSE(intersect(compiled.view().accel, ray, 0).valid());
    scene.animation.clear();
    scene.nodes[0].visible = false;
    const CompiledScene still(scene, options);
    EXPECT_FALSE(intersect(still.view().accel, ray, 0).valid());
  }
}

TEST(DeformingMeshes, HiddenNodesAreInvisibleAndEmitNothing) {
  expect_hidden_nodes_are_invisible(AccelChoice::embree);
  expect_hidden_nodes_are_invisible(AccelChoice::bvh);
}

}  // namespace
}  // namespace relume
