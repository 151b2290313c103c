#include "scene/compiled_scene.h"

#include <gtest/gtest.h>

#include "scene/builtin.h"

namespace relume {
namespace {

constexpr int kSize = 16;

Scene cornell() { return find_builtin_scene("cornell")->build(); }

Index first_mesh_node(const Scene& scene) {
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (!scene.nodes[i].meshes.empty()) return static_cast<Index>(i);
  }
  return kNone;
}

TEST(CompiledScene, TakesTheFirstCameraWhereverItsNodeStands) {
  Scene scene = cornell();
  Camera camera;
  camera.fov_y_rad = 0.3f;
  for (Node& node : scene.nodes) node.camera += node.camera == kNone ? 0 : 1;
  scene.cameras.insert(scene.cameras.begin(), camera);
  Node node;
  node.camera = 0;
  node.transform = look_at({0, 1, 9}, {0, 1, 0});
  scene.add_node(node);
  const CompiledScene compiled(std::move(scene), {.width = kSize, .height = kSize});
  EXPECT_FLOAT_EQ(compiled.view().camera.position.z, 9.0f);
  EXPECT_FLOAT_EQ(compiled.view().camera.half_extent.y, std::tan(0.15f));
}

TEST(CompiledScene, SaysWhatAnotherTimeChanges) {
  Scene scene = find_builtin_scene("slit")->build();
  CompiledScene compiled(std::move(scene), {.width = kSize, .height = kSize});
  EXPECT_EQ(compiled.set_time(0), Change::none);
  const Change moved = compiled.set_time(0.5f);
  EXPECT_TRUE(includes(moved, Change::lights));
  EXPECT_TRUE(includes(moved, Change::geometry));
  EXPECT_FALSE(includes(moved, Change::camera));
  EXPECT_EQ(compiled.set_time(0.5f) & Change::camera, Change::none);
}

TEST(CompiledScene, KeepsWhereThingsWereUntilTheFrameEnds) {
  Scene scene = cornell();
  const Index node = first_mesh_node(scene);
  CompiledScene compiled(std::move(scene), {.width = kSize, .height = kSize, .movable = {node}});
  ASSERT_TRUE(compiled.movable(node));
  Transform transform;
  transform.translation = {0, 0.25f, 0};
  EXPECT_TRUE(includes(compiled.set_transform(node, transform), Change::geometry));
  const auto displaced = [&] {
    int count = 0;
    for (const Instance& i : compiled.view().instances) {
      if (i.in_world_space) continue;
      EXPECT_NEAR(i.to_world.translation.y, 0.25f, 1e-6f);
      if (i.previous_to_world.translation != i.to_world.translation) ++count;
    }
    return count;
  };
  EXPECT_GT(displaced(), 0);
  compiled.end_frame();
  EXPECT_EQ(displaced(), 0);
}

TEST(CompiledScene, LightsCountAsChangedForOneFrame) {
  Scene scene = cornell();
  PunctualLight light;
  light.intensity = Rgb(1);
  scene.lights.push_back(light);
  Node node;
  node.light = static_cast<Index>(scene.lights.size()) - 1;
  scene.add_node(node);
  CompiledScene compiled(std::move(scene), {.width = kSize, .height = kSize});
  const auto changed = [&] {
    int count = 0;
    for (const Light& l : compiled.view().lights.lights) count += l.changed;
    return count;
  };
  EXPECT_EQ(changed(), 0);
  light.intensity = Rgb(2);
  EXPECT_EQ(compiled.set_light(0, light), Change::lights);
  EXPECT_EQ(changed(), 1);
  compiled.end_frame();
  EXPECT_EQ(changed(), 0);
}

TEST(CompiledScene, EnvironmentsAndMaterialsCanBeReplaced) {
  Scene scene = cornell();
  Material red = scene.materials[0];
  red.base_color = Rgb(1, 0, 0);
  CompiledScene compiled(std::move(scene), {.width = kSize, .height = kSize});
  const uint32_t lights = compiled.view().lights.lights.size;
  Environment environment;
  environment.kind = EnvironmentKind::constant;
  EXPECT_EQ(compiled.set_environment(environment), Change::lights);
  EXPECT_EQ(compiled.view().lights.lights.size, lights + 1);
  EXPECT_EQ(compiled.set_environment(Environment{}), Change::lights);
  EXPECT_EQ(compiled.view().lights.lights.size, lights);
  EXPECT_TRUE(includes(compiled.set_material(0, red), Change::materials));
  EXPECT_EQ(compiled.view().materials[0].base_color, Rgb(1, 0, 0));
}

TEST(CompiledScene, AnotherCameraAndBack) {
  CompiledScene compiled(cornell(), {.width = kSize, .height = kSize});
  const CameraView before = compiled.view().camera;
  PlacedCamera camera = compiled.camera();
  EXPECT_EQ(compiled.set_camera(camera), Change::none);
  camera.to_world[3].x += 1.0f;
  EXPECT_EQ(compiled.set_camera(camera), Change::camera);
  EXPECT_FLOAT_EQ(compiled.view().camera.position.x, before.position.x + 1.0f);
  EXPECT_FLOAT_EQ(compiled.view().previous_camera.position.x, before.position.x);
  EXPECT_EQ(compiled.set_camera(std::nullopt), Change::camera);
  EXPECT_EQ(compiled.view().camera.position, before.position);
}

}  // namespace
}  // namespace relume
