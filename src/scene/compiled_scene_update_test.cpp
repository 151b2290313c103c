// Updates of a compiled scene between frames.
#include <gtest/gtest.h>

#include "scene/compiled_scene.h"
#include "scene/testing/plate.h"

namespace relume {
namespace {

using testing::animate_scale;
using testing::plate;
using testing::problem_of;

constexpr int kSize = 16;

TEST(CompiledScene, RejectedChangesHaveNoEffect) {
  Scene scene = plate();
  animate_scale(scene, 1, Vec3(1), Vec3(0));
  CompiledScene compiled(scene, {.width = kSize, .height = kSize, .movable = {0}});
  const CameraView before = compiled.view().camera;
  const auto is_unchanged = [&] {
    return compiled.view().camera.position == before.position && compiled.view().camera.axes.n == before.axes.n &&
           compiled.view().instances[0].to_world.translation == Vec3(0);
  };
  std::string problem = problem_of([&] { compiled.set_time(1); });
  EXPECT_EQ(problem.rfind("plate: camera 'eye' has no direction", 0), 0u) << problem;
  EXPECT_TRUE(is_unchanged());
  problem = problem_of([&] { compiled.set_transform(0, {.translation = Vec3(1e20f)}); });
  EXPECT_NE(problem.find("node 0"), std::string::npos) << problem;
  EXPECT_TRUE(is_unchanged());
  EXPECT_EQ(compiled.source().nodes[0].transform.translation, Vec3(0));
  EXPECT_EQ(compiled.source().animation.size(), 1u);
  CameraPose camera = compiled.camera();
  camera.to_world[3].x = 1e20f;
  EXPECT_NE(problem_of([&] { compiled.set_camera(camera); }).find("the camera is beyond"), std::string::npos);
  camera.to_world = Mat4(0);
  EXPECT_NE(problem_of([&] { compiled.set_camera(camera); }).find("has no direction"), std::string::npos);
  EXPECT_TRUE(is_unchanged());
  EXPECT_EQ(compiled.set_time(0.5f), Change::none);  // the scale of a camera has no effect
}

std::vector<bool> changed_lights(const CompiledScene& compiled) {
  std::vector<bool> changed;
  for (const Light& light : compiled.view().lights.lights) changed.push_back(light.changed);
  return changed;
}

TEST(CompiledScene, EveryPropertyOfALightCounts) {
  for (const PunctualType type : {PunctualType::spot, PunctualType::directional}) {
    Scene scene = plate();
    PunctualLight light{.name = "lamp", .type = type};
    light.angular_diameter_rad = 0.1f;
    scene.lights.push_back(light);
    Node node;
    node.light = 0;
    scene.add_node(node);
    CompiledScene compiled(scene, {.width = kSize, .height = kSize});
    const auto changes = [&](auto&& edit) {
      edit(light);
      compiled.set_light(0, light);
      const bool changed = changed_lights(compiled).at(0);
      compiled.end_frame();
      return changed;
    };
    EXPECT_FALSE(changes([](PunctualLight&) {}));
    EXPECT_TRUE(changes([](PunctualLight& l) { l.intensity.g = 2; }));
    if (type == PunctualType::spot) {
      EXPECT_TRUE(changes([](PunctualLight& l) { l.outer_cone_rad = 0.5f; }));
      EXPECT_TRUE(changes([](PunctualLight& l) { l.inner_cone_rad = 0.2f; }));
    } else {
      EXPECT_TRUE(changes([](PunctualLight& l) { l.angular_diameter_rad = 0.2f; }));
    }
  }
}

TEST(CompiledScene, ChangesLastUntilTheFrameEnds) {
  Scene scene = plate();
  animate_scale(scene, 0, Vec3(1), Vec3(2));
  scene.environment.kind = EnvironmentKind::constant;
  CompiledScene compiled(scene, {.width = kSize, .height = kSize});
  Environment environment = scene.environment;
  environment.color = Rgb(2);
  compiled.set_environment(environment);
  EXPECT_TRUE(includes(compiled.set_time(0.5f), Change::lights));
  EXPECT_EQ(changed_lights(compiled), std::vector<bool>{true});
  compiled.end_frame();
  EXPECT_EQ(changed_lights(compiled), std::vector<bool>{false});

  // An additional light, of two triangles: earlier changes persist when the list is rebuilt.
  Material lamp = scene.materials[0];
  lamp.emission = Rgb(1);
  compiled.set_material(0, lamp);
  compiled.set_time(0.5f);
  EXPECT_EQ(changed_lights(compiled), (std::vector<bool>{true, true}));

  Material unlit;
  unlit.unlit = true;
  CompiledScene dark(plate(unlit), {.width = kSize, .height = kSize});
  ASSERT_TRUE(dark.view().lights.lights.empty());
  dark.set_environment(environment);
  EXPECT_EQ(changed_lights(dark), std::vector<bool>{true}) << "the first light of all";
}

/// Half of its texels are holes.
Texture holes() {
  Texture t{"holes", 2, 1, PixelFormat::rgba8_linear, WrapMode::repeat, WrapMode::repeat, FilterMode::nearest, {}, {}};
  for (const int alpha : {255, 0}) {
    for (const int code : {255, 255, 255, alpha}) t.texels.push_back(static_cast<std::byte>(code));
  }
  return t;
}

/// Adds another object, which moves next to the plate.
void add_mover(Scene& scene) {
  Mesh mesh = scene.meshes[0];
  mesh.material = static_cast<Index>(scene.materials.size());
  scene.materials.push_back({});
  Node node;
  node.meshes = {static_cast<Index>(scene.meshes.size())};
  node.transform.translation = Vec3(10, 0, 0);
  scene.meshes.push_back(mesh);
  animate_scale(scene, scene.add_node(node), Vec3(1), Vec3(1));
}

TEST(CompiledScene, FindsStaticGeometryAmongMoving) {
  Scene scene = plate();
  add_mover(scene);
  const CompiledScene compiled(scene, {.width = kSize, .height = kSize});
  for (uint32_t i = 0; i < compiled.view().instances.size; ++i) {
    const float x = compiled.view().instances[i].in_world_space ? 0.3f : 10.3f;
    const Ray ray{Vec3(x, 0.2f, 3), Vec3(0, 0, -1), kInfinity};
    const Hit hit = intersect(compiled.view().accel, ray, 0);
    ASSERT_TRUE(hit.valid());
    EXPECT_EQ(hit.instance, i);
    EXPECT_FLOAT_EQ(hit.t, 3);
    EXPECT_TRUE(occluded(compiled.view().accel, ray, 0));
    Hit packet[kPacketSize];
    const uint32_t id = 0;
    intersect_packet_from_camera(compiled.view().accel, &ray, &id, packet, 1);
    EXPECT_EQ(packet[0].instance, i);
  }
}

enum class Plate { stands_alone, moves, stands_beside_what_moves };

TEST(CompiledScene, MaterialsMayBecomeTransparent) {
  for (const Plate kind : {Plate::stands_alone, Plate::moves, Plate::stands_beside_what_moves}) {
    Material lamp;
    lamp.emission = Rgb(1);
    lamp.double_sided = true;
    lamp.base_color_texture.texture = 0;
    Scene scene = plate(lamp);
    scene.textures.push_back(holes());
    scene.meshes[0].uv0 = {Vec2(0, 1), Vec2(1, 1), Vec2(1, 0), Vec2(0, 0)};
    if (kind == Plate::moves) animate_scale(scene, 0, Vec3(1), Vec3(1));
    if (kind == Plate::stands_beside_what_moves) add_mover(scene);
    CompiledScene compiled(scene, {.width = kSize, .height = kSize});
    const auto hits = [&](float x) {
      return intersect(compiled.view().accel, {Vec3(x, 0.3f, 3), Vec3(0, 0, -1), kInfinity}, 0).valid();
    };
    const auto watts = [&] {
      const LightsView& lights = compiled.view().lights;  // a parallelogram while it is opaque, else two triangles
      float sum = 0;
      for (LightId id = 0; id < lights.lights.size; ++id) sum += power(lights, id).r;
      return sum;
    };
    const float whole = watts();
    EXPECT_TRUE(hits(-0.5f) && hits(0.5f));
    lamp.alpha_mode = AlphaMode::mask;
    EXPECT_EQ(compiled.set_material(0, lamp), Change::materials | Change::lights);
    EXPECT_TRUE(hits(-0.5f) && !hits(0.5f)) << static_cast<int>(kind);
    EXPECT_NEAR(watts(), 0.5f * whole, 0.02f * whole);
    EXPECT_TRUE(changed_lights(compiled).at(0));
    lamp.alpha_cutoff = 0;  // opaque again
    compiled.set_material(0, lamp);
    EXPECT_TRUE(hits(-0.5f) && hits(0.5f));
    EXPECT_NEAR(watts(), whole, 0.02f * whole);
    lamp.alpha_cutoff = 0.5f;
    lamp.alpha_mode = AlphaMode::opaque;
    compiled.set_material(0, lamp);
    EXPECT_TRUE(hits(-0.5f) && hits(0.5f));
    EXPECT_NEAR(watts(), whole, 0.02f * whole);
    lamp.base_color_texture.texture = 7;
    EXPECT_NE(problem_of([&] { compiled.set_material(0, lamp); }).find("refers to texture 7"), std::string::npos);
  }
}

}  // namespace
}  // namespace relume
