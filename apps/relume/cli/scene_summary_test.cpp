#include "cli/scene_summary.h"

#include <gtest/gtest.h>

namespace relume::cli {
namespace {

Scene scene_with_a_triangle_three_times() {
  Scene scene;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.material = 0;
  scene.meshes = {mesh};
  Material light;
  light.emission = Rgb(5);
  scene.materials = {light, Material{}};
  Camera camera;
  camera.name = "Door";
  scene.cameras = {camera, Camera{}};
  Node once;
  once.meshes = {0};
  once.transform.translation = {10, 0, 0};
  scene.add_node(once);
  Node twice;
  twice.meshes = {0};
  twice.instances = {Mat4(1), Mat4(1)};
  twice.instances[1][3] = {0, 0, -4, 1};
  scene.add_node(twice);
  scene.warnings = {"a texture is missing"};
  return scene;
}

TEST(SceneSummary, CountsPlacedParts) {
  const SceneSummary summary = summarize(scene_with_a_triangle_three_times());
  EXPECT_EQ(summary.triangles, 1u);
  EXPECT_EQ(summary.instanced_triangles, 3u);
  EXPECT_EQ(summary.mesh_instances, 3u);
  EXPECT_EQ(summary.emissive_materials, 1u);
  EXPECT_EQ(summary.bounds_min, Vec3(0, 0, -4));
  EXPECT_EQ(summary.bounds_max, Vec3(11, 2, 0));
  EXPECT_EQ(summary.geometry_bytes, 3 * sizeof(Vec3) + sizeof(UVec3));
}

TEST(SceneSummary, TextNamesCamerasAndWarnings) {
  const std::string text = to_text(summarize(scene_with_a_triangle_three_times()));
  EXPECT_NE(text.find("0 Door (perspective)"), std::string::npos) << text;
  EXPECT_NE(text.find("1 without a name"), std::string::npos) << text;
  EXPECT_NE(text.find("a texture is missing"), std::string::npos) << text;
  EXPECT_NE(text.find("(11, 2, 4) m"), std::string::npos) << text;
}

TEST(SceneSummary, TextHasNoControlCharactersOfNames) {
  Scene scene = scene_with_a_triangle_three_times();
  scene.cameras[0].name = "a\nb\x1b[2J\x7f\té";
  scene.warnings = {"'\x1b]0;title\x07' is missing"};
  const std::string text = to_text(summarize(scene));
  EXPECT_NE(text.find(R"(0 a\nb\x1b[2J\x7f\té (perspective))"), std::string::npos) << text;
  EXPECT_NE(text.find(R"('\x1b]0;title\x07' is missing)"), std::string::npos) << text;
}

TEST(SceneSummary, EmptySceneHasNoBounds) {
  const std::string text = to_text(summarize(Scene{}));
  EXPECT_EQ(text.find("bounds"), std::string::npos);
  EXPECT_NE(text.find("triangles     0, with instances 0"), std::string::npos) << text;
}

}  // namespace
}  // namespace relume::cli
