#include "viewer/model/document.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "builtin_scenes/builtin.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "relume/image_io.h"
#include "relume/scene_io.h"
#include "scene/testing/figure.h"
#include "viewer/model/save_view.h"

namespace relume::viewer {
namespace {

constexpr float kTolerance = 1e-4f;  // metres; allows for matrix inversion

void expect_near(const Vec3& a, const Vec3& b, float tolerance = kTolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

Mesh quad() {
  Mesh mesh;
  mesh.positions = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = 0;
  return mesh;
}

/// A parent with rotation and scale, and below it a quad and a lamp.
std::shared_ptr<const LoadedScene> small_scene() {
  Scene scene;
  scene.materials.emplace_back().name = "paint";
  scene.meshes.push_back(quad());
  scene.lights.emplace_back().name = "lamp";
  Node parent;
  parent.name = "parent";
  parent.transform = {{10, 0, 0}, glm::quat(std::cos(kPi / 4), 0, std::sin(kPi / 4), 0), Vec3(2)};
  Node table;
  table.name = "table";
  table.parent = 0;
  table.meshes = {0};
  Node lamp;
  lamp.name = "lamp";
  lamp.parent = 0;
  lamp.light = 0;
  lamp.transform.translation = {0, 3, 0};
  scene.nodes = {parent, table, lamp};
  return std::make_shared<const LoadedScene>(LoadedScene{"small", scene});
}

TEST(Document, MovesInWorldSpaceBelowATurnedParent) {
  Document document(small_scene());
  const Vec3 before(document.world()[2][3]);
  expect_near(before, {10, 6, 0});
  document.move(2, {1, 2, 3});
  expect_near(Vec3(document.world()[2][3]), before + Vec3(1, 2, 3));
  EXPECT_EQ(document.edits().nodes.count(2), 1u);
}

TEST(Document, BoundsFollowMovingObjects) {
  Document document(small_scene());
  expect_near(document.bounds(1).low, {8, 0, -2});
  expect_near(document.bounds(1).high, {12, 0, 2});
  document.move(1, {0, 5, 0});
  expect_near(document.bounds().center(), {10, 5, 0});
  EXPECT_TRUE(document.bounds(2).empty()) << "a lamp has no meshes";
}

TEST(Document, BoxesOfManyInstancesStopAtTheLimit) {
  auto loaded = std::make_shared<LoadedScene>(*small_scene());
  const auto carrier = std::find_if(loaded->scene.nodes.begin(), loaded->scene.nodes.end(),
                                    [](const Node& n) { return !n.meshes.empty(); });
  ASSERT_NE(carrier, loaded->scene.nodes.end());
  carrier->instances.assign(100, Mat4(1));
  const Document document(loaded);
  const Index node = static_cast<Index>(carrier - loaded->scene.nodes.begin());
  EXPECT_EQ(document.boxes(node, 64).size(), 64u);
}

TEST(Document, OnlyMeshesNeedToBeMadeMovable) {
  Document document(small_scene());
  EXPECT_FALSE(document.make_movable(2));
  EXPECT_TRUE(document.make_movable(1));
  EXPECT_FALSE(document.make_movable(1)) << "it is by now";
  EXPECT_EQ(document.edits().movable, (std::vector<Index>{1}));
}

TEST(Document, PlaysTheChosenClip) {
  Scene scene = testing::figure();
  scene.clips.emplace_back("stretch");
  scene.animation.push_back({1, AnimatedProperty::scale, Interpolation::linear, {0, 3}, {Vec4(1), Vec4(3)}, 0, 1});
  Document document(std::make_shared<const LoadedScene>(LoadedScene{"figure", std::move(scene), 0}));
  EXPECT_EQ(document.duration_s(), 1);
  document.play("stretch");
  EXPECT_EQ(document.duration_s(), 3);
  document.set_time(3);
  expect_near(document.bounds(0).high, Vec3(0.6f, 6, 0.6f));  // scaled by three, like its joints
  EXPECT_THROW(document.play("sing"), Error);
  document.set_transform(1, {});
  expect_near(document.bounds(0).high, Vec3(0.2f, 2, 0.2f));
  document.play("bend");
  EXPECT_TRUE(std::none_of(document.outline().animation.begin(), document.outline().animation.end(),
                           [](const AnimationChannel& channel) { return channel.node == 1; }));
}

TEST(Document, ShowsTheChosenVariant) {
  Scene scene = testing::figure();
  scene.materials.emplace_back();
  scene.variants = {"red"};
  scene.meshes[0].variants = {{0, 1}};
  Document document(std::make_shared<const LoadedScene>(LoadedScene{"figure", std::move(scene), 0}));
  document.choose_variant("red");
  EXPECT_EQ(document.outline().meshes[0].material, 1);
  EXPECT_THROW(document.choose_variant("blue"), Error);
  document.choose_variant("");
  EXPECT_EQ(document.outline().meshes[0].material, 0);
}

TEST(Document, EditsCarryRisingVersions) {
  Document document(small_scene());
  document.set_light(0, {});
  const uint64_t first = document.edits().lights.at(0).version;
  document.set_material(0, {});
  EXPECT_GT(document.edits().materials.at(0).version, first);
  EXPECT_EQ(document.edits().version, document.edits().materials.at(0).version);
}

TEST(Document, KeepsTheMapOfTheEnvironment) {
  auto loaded = std::make_shared<LoadedScene>(*small_scene());
  Environment& e = loaded->scene.environment;
  e.kind = EnvironmentKind::map;
  e.width = 2;
  e.height = 1;
  e.map = {Rgb(1), Rgb(2)};
  Document document(loaded);
  EXPECT_TRUE(document.outline().environment.map.empty());
  Environment changed = document.outline().environment;
  changed.rotation_rad = 1;
  document.set_environment(changed);
  EXPECT_EQ(document.edits().environment.value->map.size(), 2u);
  EXPECT_EQ(document.edits().environment.value->rotation_rad, 1);
}

// --- Reloading -------------------------------------------------------------------------------------------------------

TEST(RepeatEdits, FollowNamesNotIndices) {
  Document before(small_scene());
  before.make_movable(1);
  before.move(1, {0, 5, 0});
  PunctualLight lamp = before.outline().lights[0];
  lamp.intensity = Rgb(7);
  before.set_light(0, lamp);
  Material paint = before.outline().materials[0];
  paint.roughness = 0.125f;
  before.set_material(0, paint);

  auto loaded = std::make_shared<LoadedScene>(*small_scene());
  Scene& scene = loaded->scene;
  scene.materials.insert(scene.materials.begin(), Material{});
  scene.materials[1].base_color_texture.texture = 3;
  scene.meshes[0].material = 1;
  scene.lights.insert(scene.lights.begin(), PunctualLight{});
  scene.nodes[2].light = 1;
  std::swap(scene.nodes[1], scene.nodes[2]);
  Document after(loaded);
  EXPECT_TRUE(after.repeat_edits(before).empty());
  expect_near(after.bounds().center(), before.bounds().center());
  EXPECT_EQ(after.edits().movable, (std::vector<Index>{2}));
  EXPECT_EQ(after.outline().lights[1].intensity, Rgb(7));
  EXPECT_EQ(after.outline().materials[1].roughness, 0.125f);
  EXPECT_EQ(after.outline().materials[1].base_color_texture.texture, 3) << "as the file numbers them now";
  EXPECT_EQ(after.edits().materials.count(0), 0u);
}

TEST(RepeatEdits, ReportItemsWithoutUniqueNames) {
  Document before(small_scene());
  before.set_light(0, {.name = "lamp", .type = PunctualType::spot});
  before.set_transform(1, {});
  auto loaded = std::make_shared<LoadedScene>(*small_scene());
  loaded->scene.nodes[1].name = "desk";
  Document after(loaded);
  EXPECT_EQ(after.repeat_edits(before), (std::vector<std::string>{"object 'table'"}));
  EXPECT_EQ(after.edits().lights.size(), 1u);
}

TEST(RepeatEdits, KeepTheEnvironmentThatWasEdited) {
  Document before(small_scene());
  Environment sky = before.outline().environment;
  sky.color = {1, 2, 3};
  before.set_environment(sky);
  Document after(small_scene());
  EXPECT_TRUE(after.repeat_edits(before).empty());
  EXPECT_EQ(after.outline().environment.color, sky.color);
  Document replaced(small_scene());
  replaced.replace_environment(sky);
  Document untouched(small_scene());
  untouched.repeat_edits(replaced);
  EXPECT_FALSE(untouched.environment_is_edited()) << "settings bring it, which count again";
}

// --- Saving -------------------------------------------------------------------------------------------------------

struct Saved {
  Scene scene;
  std::vector<std::string> omissions;
};

/// Writes the view and loads it again.
Saved round_trip(const Document& document, const AllSettings& settings, const CameraPose& camera,
                 const CameraPath* path) {
  const TempFolder folder;
  const std::filesystem::path file = folder / "view.json";
  Saved saved;
  saved.omissions = save_view(file, {document, settings, camera, path});
  saved.scene = load_scene(file);
  return saved;
}

Document cornell() {
  return Document(std::make_shared<const LoadedScene>(LoadedScene{"cornell", find_builtin_scene("cornell")->build()}));
}

CameraPose some_camera() {
  CameraPose camera;
  const Transform t = look_at({1, 2, 5}, {0, 1, 0});
  camera.to_world = glm::mat4_cast(t.rotation);
  camera.to_world[3] = Vec4(t.translation, 1);
  camera.camera.fov_y_rad = 0.5f;
  return camera;
}

TEST(SaveView, RestoresCameraAndSettings) {
  AllSettings settings;
  settings.render.path.max_bounces = 3;
  const CameraPose camera = some_camera();
  const Saved saved = round_trip(cornell(), settings, camera, nullptr);
  EXPECT_TRUE(saved.omissions.empty());
  const Mat4 loaded = world_matrices(saved.scene, 0).back();
  for (int c = 0; c < 4; ++c) expect_near(Vec3(loaded[c]), Vec3(camera.to_world[c]));
  EXPECT_NEAR(saved.scene.cameras.front().fov_y_rad, 0.5f, 1e-5f);
  EXPECT_EQ(nlohmann::json::parse(saved.scene.settings_json),
            (nlohmann::json{{"exposure", "auto"}, {"max-bounces", 3}, {"tone-map", "auto"}}))
      << "the view goes back to what is automatic, which the built-in scene fixes";
}

TEST(SaveView, RestoresFixedExposures) {
  AllSettings settings;
  settings.output.exposure = 1.5f;
  const Saved saved = round_trip(cornell(), settings, some_camera(), nullptr);
  EXPECT_EQ(nlohmann::json::parse(saved.scene.settings_json)["exposure"], 1.5f);
}

TEST(SaveView, ARecordedPathMovesTheCamera) {
  CameraPath path;
  const Transform from = look_at({0, 1, 5}, {0, 1, 0});
  const Transform to = look_at({2, 1, 5}, {2, 1, 0});
  path.add({0, from.translation, from.rotation});
  path.add({4, to.translation, to.rotation});
  const Saved saved = round_trip(cornell(), {}, some_camera(), &path);
  EXPECT_EQ(animation_end(saved.scene), 4);
  expect_near(Vec3(world_matrices(saved.scene, 1).back()[3]), path.at(1).eye);
}

TEST(SaveView, RestoresEnvironmentAndTime) {
  const TempFolder folder;
  Image sky_map(4, 2);
  for (Rgb& texel : sky_map.pixels) texel = Rgb(0.5f, 1, 2);
  write_image(folder / "sky.hdr", sky_map);
  Document document = cornell();
  AllSettings settings;
  settings.scene.env = (folder / "sky.hdr").string();
  Scene sky;
  apply(settings.scene, sky);
  sky.environment.rotation_rad = 0.5f;
  document.replace_environment(sky.environment);
  document.set_time(1.5f);
  const Saved saved = round_trip(document, settings, some_camera(), nullptr);
  EXPECT_TRUE(saved.omissions.empty());
  EXPECT_EQ(saved.scene.environment.map, sky.environment.map);
  EXPECT_NEAR(saved.scene.environment.rotation_rad, 0.5f, 1e-5f);
  EXPECT_EQ(nlohmann::json::parse(saved.scene.settings_json)["scene-time"], 1.5f);
}

TEST(SaveView, MovedObjectsAreNoLongerAnimated) {
  Document document(
      std::make_shared<const LoadedScene>(LoadedScene{"turntable", find_builtin_scene("turntable")->build()}));
  ASSERT_FALSE(document.outline().animation.empty());
  const Index node = document.outline().animation[0].node;
  document.set_time(0.5f);
  document.move(node, {0.5f, 0.25f, 0});
  const Saved saved = round_trip(document, {}, some_camera(), nullptr);
  EXPECT_TRUE(saved.omissions.empty());
  const auto at = static_cast<size_t>(node);
  for (const float time : {0.0f, 0.5f, 3.0f}) {
    for (int c = 0; c < 4; ++c)
      expect_near(Vec3(world_matrices(saved.scene, time)[at][c]), Vec3(document.world()[at][c]));
  }
}

TEST(SaveView, ASingleKeyIsNoPath) {
  const Document document = cornell();
  CameraPath path;
  std::vector<std::string> omissions;
  const auto moves = [&] {
    return view_as_json({document, {}, some_camera(), &path}, ".", omissions).find("camera_keys") != std::string::npos;
  };
  EXPECT_FALSE(moves());
  path.add({.time_s = 0});
  EXPECT_FALSE(moves());
  path.add({.time_s = 1});
  EXPECT_TRUE(moves());
}

TEST(SaveView, ReportsSharedNames) {
  auto loaded = std::make_shared<LoadedScene>(*small_scene());
  for (Node& node : loaded->scene.nodes) node.name = "same";
  Document document(loaded);
  document.set_transform(0, Transform{});
  std::vector<std::string> omissions;
  view_as_json({document, {}, some_camera(), nullptr}, ".", omissions);
  ASSERT_EQ(omissions.size(), 1u);
  EXPECT_NE(omissions[0].find("shares the name 'same'"), std::string::npos);
}

TEST(SaveView, ReportsOpenColorIOViews) {
  std::vector<std::string> omissions;
  view_as_json({cornell(), {}, some_camera(), nullptr, true}, ".", omissions);
  ASSERT_EQ(omissions.size(), 1u);
  EXPECT_NE(omissions[0].find("--ocio is not saved"), std::string::npos);
}

TEST(SaveView, RestoresOrReportsSceneChanges) {
  Document document = cornell();
  Material material = document.outline().materials[0];
  material.roughness = 0.125f;
  document.set_material(0, material);
  Index named = kNone;
  for (size_t i = 0; i < document.outline().nodes.size(); ++i) {
    const Node& node = document.outline().nodes[i];
    if (!node.meshes.empty() && !node.name.empty()) named = static_cast<Index>(i);
  }
  ASSERT_NE(named, kNone);
  document.move(named, {0.5f, 0.25f, 0});
  Environment sky;
  sky.kind = EnvironmentKind::sun_sky;
  sky.color = {0.5f, 0.25f, 2};
  sky.rotation_rad = 0.75f;
  sky.sun_sky.sun_elevation_rad = 0.3f;
  document.set_environment(sky);
  const Saved saved = round_trip(document, {}, some_camera(), nullptr);
  EXPECT_TRUE(saved.omissions.empty());
  EXPECT_FLOAT_EQ(saved.scene.materials[0].roughness, 0.125f);
  const auto at = static_cast<size_t>(named);
  for (int c = 0; c < 4; ++c) expect_near(Vec3(world_matrices(saved.scene, 0)[at][c]), Vec3(document.world()[at][c]));
  EXPECT_NEAR(saved.scene.environment.sun_sky.sun_elevation_rad, 0.3f, 1e-5f);
  EXPECT_EQ(saved.scene.environment.color, sky.color);
  EXPECT_NEAR(saved.scene.environment.rotation_rad, 0.75f, 1e-5f);

  Document lamp(small_scene());
  lamp.set_light(0, {});
  std::vector<std::string> omissions;
  view_as_json({lamp, {}, some_camera(), nullptr}, ".", omissions);
  EXPECT_EQ(omissions.size(), 1u) << "relume JSON cannot change lights";
}

}  // namespace
}  // namespace relume::viewer
