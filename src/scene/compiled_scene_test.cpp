#include "scene/compiled_scene.h"

#include <limits>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "scene/testing/plate.h"
#include "scene/world_triangles.h"

namespace relume {
namespace {

using testing::animate_scale;
using testing::plate;
using testing::problem_of;

constexpr int kSize = 16;

Scene cornell() { return find_builtin_scene("cornell")->build(); }

Index first_mesh_node(const Scene& scene) {
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (!scene.nodes[i].meshes.empty()) return static_cast<Index>(i);
  }
  return kNone;
}

TEST(CompiledScene, TakesTheFirstCameraInAnyNodeOrder) {
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

TEST(CompiledScene, ReportsChangesOfAnotherTime) {
  Scene scene = find_builtin_scene("slit")->build();
  CompiledScene compiled(std::move(scene), {.width = kSize, .height = kSize});
  EXPECT_EQ(compiled.set_time(0), Change::none);
  const Change moved = compiled.set_time(0.5f);
  EXPECT_TRUE(includes(moved, Change::lights));
  EXPECT_TRUE(includes(moved, Change::geometry));
  EXPECT_FALSE(includes(moved, Change::camera));
  EXPECT_EQ(compiled.set_time(0.5f) & Change::camera, Change::none);
}

TEST(CompiledScene, KeepsPreviousTransformsUntilTheFrameEnds) {
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
  EXPECT_EQ(compiled.set_environment(environment), Change::lights | Change::light_list);
  EXPECT_EQ(compiled.view().lights.lights.size, lights + 1);
  EXPECT_EQ(compiled.set_environment(Environment{}), Change::lights | Change::light_list);
  EXPECT_EQ(compiled.view().lights.lights.size, lights);
  EXPECT_TRUE(includes(compiled.set_material(0, red), Change::materials));
  EXPECT_EQ(compiled.view().materials[0].base_color, Rgb(1, 0, 0));
}

TEST(CompiledScene, SwitchesCamerasAndBack) {
  CompiledScene compiled(cornell(), {.width = kSize, .height = kSize});
  const CameraView before = compiled.view().camera;
  CameraPose camera = compiled.camera();
  EXPECT_EQ(compiled.set_camera(camera), Change::none);
  camera.to_world[3].x += 1.0f;
  EXPECT_EQ(compiled.set_camera(camera), Change::camera);
  EXPECT_FLOAT_EQ(compiled.view().camera.position.x, before.position.x + 1.0f);
  EXPECT_FLOAT_EQ(compiled.view().previous_camera.position.x, before.position.x);
  EXPECT_EQ(compiled.set_camera(std::nullopt), Change::camera);
  EXPECT_EQ(compiled.view().camera.position, before.position);
}

std::string notes_of(const Scene& scene) {
  std::string all;
  const CompiledScene compiled(scene, {.width = kSize, .height = kSize});
  for (const std::string& note : compiled.notes()) all += note + "\n";
  return all;
}

constexpr const char* kCollapsed = "plate: camera 'eye' has no direction, because a scale of 0";

TEST(CompiledScene, RejectsCollapsedCameras) {
  Scene scene = plate();
  scene.nodes[1].transform.scale = Vec3(0);
  const std::string problem = problem_of([&] { CompiledScene(scene, {.width = kSize, .height = kSize}); });
  EXPECT_EQ(problem.rfind(kCollapsed, 0), 0u) << problem;
}

TEST(CompiledScene, RejectsScenesBeyondTheExtentLimit) {
  Scene scene = plate();
  scene.nodes[0].transform.scale = Vec3(9e8f);
  EXPECT_EQ(problem_of([&] { CompiledScene(scene, {}); }), "");
  for (Vec3& p : scene.meshes[0].positions) p *= 2.0f;
  EXPECT_NE(problem_of([&] { CompiledScene(scene, {}); }).find("reaches 1.8e+09 m"), std::string::npos);
}

TEST(CompiledScene, LightsWithoutDirectionAreDark) {
  for (const PunctualType type : {PunctualType::spot, PunctualType::directional, PunctualType::point}) {
    Scene scene = plate();
    scene.lights.push_back({.name = "lamp", .type = type});
    Node node;
    node.light = 0;
    node.transform.scale = Vec3(0);
    scene.add_node(node);
    const CompiledScene compiled(scene, {.width = kSize, .height = kSize});
    const LightsView& lights = compiled.view().lights;
    const bool shines = type == PunctualType::point;
    EXPECT_EQ(is_black(power(lights, 0)), !shines);
    EXPECT_TRUE(is_finite(sample_li(lights, 0, Vec3(1), Vec2(0.5f)).wi));
    EXPECT_EQ(notes_of(scene).find("light 'lamp' is dark") == std::string::npos, shines);
    EXPECT_EQ(notes_of(scene).find("the image is black") == std::string::npos, shines);
  }
}

/// Number of 64 parallel rays that hit something.
int hits_of_grid(const AccelView& accel) {
  int count = 0;
  for (int i = 0; i < 64; ++i)
    count += intersect(accel, {Vec3(Vec2(i % 8, i / 8) * 0.2f - 0.7f, 3), Vec3(0, 0, -1), kInfinity}, 0).valid();
  return count;
}

TEST(CompiledScene, CollapsedInstancesAreInvisible) {
  for (const AccelChoice accel : {AccelChoice::embree, AccelChoice::bvh}) {
    for (const Vec3& collapsed : {Vec3(0), Vec3(1, 1, 0), Vec3(0, 1, 1), Vec3(1e-30f)}) {
      Scene scene = plate();
      animate_scale(scene, 0, collapsed, Vec3(1));
      CompiledScene compiled(scene, {.width = kSize, .height = kSize, .accel = accel});
      for (const int time_s : {0, 1, 0}) {
        compiled.set_time(static_cast<float>(time_s));
        EXPECT_EQ(hits_of_grid(compiled.view().accel), 64 * time_s);
      }
    }
  }
}

TEST(CompiledScene, NonFiniteRaysHitNothing) {
  const CompiledScene compiled(plate(), {.width = kSize, .height = kSize});
  const AccelView& accel = compiled.view().accel;
  const Vec3 down(0, 0, -1);
  const Ray rays[] = {
      {Vec3(0.1f, 0.2f, 3), down, kInfinity},       {Vec3(0, 0, kInfinity), down, kInfinity},
      {Vec3(0, std::nanf(""), 3), down, kInfinity}, {Vec3(0, 0, 3), Vec3(0, 0, std::nanf("")), kInfinity},
      {Vec3(0, 0, 1e20f), down, kInfinity},         {Vec3(0, 0, 3), down, std::nanf("")}};
  constexpr int kCount = 6;
  const uint32_t ids[kCount] = {};
  Hit hits[kCount];
  bool blocked[kCount];
  intersect_packet_from_camera(accel, rays, ids, hits, kCount);
  occluded_packet(accel, rays, ids, blocked, kCount);
  for (int i = 0; i < kCount; ++i) {
    EXPECT_EQ(intersect(accel, rays[i], 0).valid(), i == 0) << i;
    EXPECT_EQ(occluded(accel, rays[i], 0), i == 0) << i;
    EXPECT_EQ(hits[i].valid(), i == 0) << i;
    EXPECT_EQ(blocked[i], i == 0) << i;
  }
}

/// Whether an automatic environment becomes the studio.
bool gets_studio(Scene scene) {
  scene.environment.kind = EnvironmentKind::automatic;
  return CompiledScene(std::move(scene), {.width = kSize, .height = kSize}).in_studio();
}

/// The plate next to a lamp of this radiance.
Scene plate_under_lamp(float radiance) {
  Scene scene = plate();
  Material lamp;
  lamp.emission = Rgb(radiance);
  lamp.double_sided = true;
  lamp.base_color = Rgb(0);
  scene.materials.push_back(lamp);
  scene.meshes.push_back(scene.meshes[0]);
  scene.meshes[1].material = static_cast<Index>(scene.materials.size()) - 1;
  Node node;
  node.meshes = {1};
  node.transform.translation = {1.5f, 0, 1};
  node.transform.scale = Vec3(0.3f);
  scene.add_node(node);
  return scene;
}

TEST(CompiledScene, UsesTheStudioIfNothingLightsVisibleSurfaces) {
  EXPECT_TRUE(gets_studio(plate()));
  EXPECT_FALSE(gets_studio(plate_under_lamp(30)));
  EXPECT_TRUE(gets_studio(plate_under_lamp(0.001f))) << "emission that only decorates";
  Scene unlit_scene = plate();
  unlit_scene.environment.kind = EnvironmentKind::automatic;
  EXPECT_NE(notes_of(unlit_scene).find("the scene has no light: using the studio environment"), std::string::npos);
  Material lamp;
  lamp.emission = Rgb(1);
  EXPECT_TRUE(gets_studio(plate(lamp))) << "a lamp that lights nothing but itself";
  Material unlit;
  unlit.unlit = true;
  EXPECT_FALSE(gets_studio(plate(unlit))) << "unlit surfaces need no light";
}

TEST(CompiledScene, ChoosesTheStudioFromAnyEnvironment) {
  Scene scene = plate();
  scene.environment.kind = EnvironmentKind::sun_sky;
  CompiledScene compiled(scene, {.width = kSize, .height = kSize});
  EXPECT_FALSE(compiled.in_studio());
  Environment automatic;
  automatic.kind = EnvironmentKind::automatic;
  compiled.set_environment(automatic);
  EXPECT_TRUE(compiled.in_studio());
  compiled.set_environment({});
  EXPECT_FALSE(compiled.in_studio());
}

TEST(CompiledScene, PunctualLightsReplaceTheStudio) {
  Scene scene = plate();
  scene.lights.push_back({.name = "lamp", .type = PunctualType::point});
  Node node;
  node.light = 0;
  node.transform.translation = {0, 0, 1};
  scene.add_node(node);
  EXPECT_FALSE(gets_studio(scene));
  scene.lights[0].intensity = Rgb(0);
  EXPECT_TRUE(gets_studio(scene));
}

TEST(CompiledScene, NotesScenesWithoutLight) {
  EXPECT_NE(notes_of(plate()).find("the image is black"), std::string::npos);
  Scene scene = plate();
  scene.environment.kind = EnvironmentKind::constant;
  EXPECT_EQ(notes_of(scene), "");
}

TEST(CompiledScene, BoundsContainTheWholeAnimation) {
  Scene scene = plate();
  scene.animation.push_back(
      {0, AnimatedProperty::translation, Interpolation::linear, {0, 1, 2}, {Vec4(0), Vec4(50, 0, 0, 0), Vec4(0)}});
  const auto at = [&](float time_s) {
    return CompiledScene(scene, {.time_s = time_s, .width = kSize, .height = kSize}).bounds();
  };
  EXPECT_GE(at(0).radius, 25.0f);
  EXPECT_NEAR(at(0).center.x, 25.0f, 1e-3f);
  EXPECT_EQ(at(0).radius, at(1.3f).radius);  // for any start time
  EXPECT_EQ(at(0).center, at(1.3f).center);
  // Half a turn about a far point: neither key shows how high the path goes.
  Scene turning = plate();
  turning.nodes[0].parent = 2;
  turning.nodes[0].transform.translation = Vec3(10, 0, 0);
  turning.add_node({});
  turning.animation.push_back({2,
                               AnimatedProperty::rotation,
                               Interpolation::linear,
                               {0, 1, 2},
                               {Vec4(0, 0, 0, 1), Vec4(0, 0, std::sqrt(0.5f), std::sqrt(0.5f)), Vec4(0, 0, 1, 0)}});
  EXPECT_GT(CompiledScene(turning, {}).bounds().radius, 10.0f);
  CompiledScene edited(plate(), {.movable = {0}});
  edited.set_transform(0, {.translation = Vec3(0, 100, 0)});
  EXPECT_GT(edited.bounds().radius, 50.0f);
}

TEST(CompiledScene, BoundsHoldOneKeyAmongThousands) {
  Scene scene = plate();
  AnimationChannel away{0, AnimatedProperty::translation, Interpolation::linear, {}, {}};
  for (int i = 0; i < 3000; ++i) {
    away.times.push_back(static_cast<float>(i));
    away.values.emplace_back(i == 1234 ? 100.0f : 0.0f, 0, 0, 0);
  }
  scene.animation.push_back(away);
  EXPECT_GE(CompiledScene(scene, {}).bounds().radius, 50.0f);
}

TEST(CompiledScene, NormalsSurviveTheLargestScales) {
  for (const float scale : {1e-6f, 1.0f, 7e8f}) {
    CompiledScene scene(plate(), {.movable = {0}});
    scene.set_transform(0, {.scale = Vec3(scale)});
    const Vec3 normal = scene.view().instances[0].normal_to_world * Vec3(0, 0, 32767);
    const float length = glm::length(normal);
    EXPECT_TRUE(std::isfinite(length) && length > 0) << scale;
    EXPECT_NEAR(normal.z / length, 1, 1e-6f);
  }
}

TEST(CompiledScene, RejectsSunsAboveTheRadianceLimit) {
  Scene scene = plate();
  scene.environment.kind = EnvironmentKind::sun_sky;
  scene.environment.sun_sky.sun_scale = 1e8f;
  EXPECT_EQ(problem_of([&] { validate(scene, "a"); }), "");
  scene.environment.sun_sky.sun_scale = 1e20f;
  EXPECT_NE(problem_of([&] { validate(scene, "a"); }).find("the sun or the sky"), std::string::npos);
  scene.environment.sun_sky.sun_scale = 1e8f;
  scene.environment.sun_sky.sun_angular_diameter_rad = 3e-6f;
  EXPECT_NE(problem_of([&] { validate(scene, "a"); }).find("the sun or the sky"), std::string::npos);
}

TEST(CompiledScene, RejectsCropsThatAreNoPartOfTheImage) {
  Scene scene = plate();
  scene.crop = {.left = 0.25f, .top = 0.5f, .right = 0.75f, .bottom = 1};
  EXPECT_EQ(problem_of([&] { validate(scene, "a"); }), "");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const ImagePart& crop : {ImagePart{.left = 0.5f, .right = 0.5f}, ImagePart{.left = -0.1f},
                                ImagePart{.bottom = 1.1f}, ImagePart{.top = nan}}) {
    scene.crop = crop;
    EXPECT_NE(problem_of([&] { validate(scene, "a"); }).find("is not a part of the image"), std::string::npos);
  }
}

TEST(CompiledScene, CountsItsMemory) {
  const auto bytes_of = [](Scene scene) {
    return CompiledScene(std::move(scene), {.width = kSize, .height = kSize}).memory_bytes();
  };
  const size_t plain = bytes_of(cornell());
  EXPECT_GT(plain, placed_triangles(cornell()) * sizeof(UVec3));
  Scene with_map = cornell();
  Environment& environment = with_map.environment;
  environment.kind = EnvironmentKind::map;
  environment.width = 64;
  environment.height = 32;
  environment.map.assign(64 * 32, Rgb(1));
  EXPECT_GT(bytes_of(with_map), plain + 64 * 32 * sizeof(Rgb));
}

TEST(WorldTriangles, BoxIsUpdatedWithTransforms) {
  CompiledScene scene(plate(), {.width = kSize, .height = kSize, .movable = {0}});
  EXPECT_EQ(world_box(scene.view()).low, Vec3(-1, -1, 0));
  EXPECT_EQ(world_box(scene.view()).high, Vec3(1, 1, 0));
  scene.set_transform(0, {.translation = Vec3(0, 100, 2)});
  EXPECT_EQ(world_box(scene.view()).low, Vec3(-1, 99, 2));
  EXPECT_EQ(world_box(scene.view()).high, Vec3(1, 101, 2));
  EXPECT_TRUE(world_box(SceneView{}).empty());
}

TEST(WorldTriangles, TheBoxOfManyInstancesIsThatOfTheirTriangles) {
  Scene source = plate();
  Mat4 place(1);
  for (int i = 0; i < 60; ++i) {
    place = glm::rotate(glm::translate(place, Vec3(0.3f, 0.1f, -0.2f)), 0.7f, glm::normalize(Vec3(1, 2, 3)));
    source.nodes[0].instances.push_back(place);
  }
  const CompiledScene scene(std::move(source), {.width = kSize, .height = kSize});
  Box expected;
  for_each_world_triangle(scene.view(), [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    for (const Vec3& corner : {a, b, c}) expected.add(corner);
  });
  EXPECT_EQ(world_box(scene.view()).low, expected.low);
  EXPECT_EQ(world_box(scene.view()).high, expected.high);
}

}  // namespace
}  // namespace relume
