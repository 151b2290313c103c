#include <utility>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "relume/error.h"
#include "scene/compiled_scene.h"

namespace relume {
namespace {

Mesh triangle(Index material) {
  return {.name = "triangle",
          .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
          .normals = {},
          .tangents = {},
          .uv0 = {},
          .uv1 = {},
          .colors = {},
          .triangles = {{0, 1, 2}},
          .material = material};
}

Node node_of(Index mesh) {
  Node node;
  node.name = "added";
  node.meshes = {mesh};
  return node;
}

/// Whether a ray along −Z from z = 10 metres hits a triangle of `mesh` at (x, y).
bool meets(const CompiledScene& scene, float x, float y) {
  const Ray ray{{x, y, 10}, {0, 0, -1}, kInfinity};
  return intersect(scene.view().accel, ray, 0).valid();
}

class EmptyScene : public ::testing::Test {
 protected:
  static Scene with_camera() {
    Scene scene;
    scene.cameras.push_back({.name = "camera"});
    Node camera;
    camera.camera = 0;
    camera.transform.translation = {0, 0, 5};
    scene.add_node(camera);
    return scene;
  }
  CompiledScene scene_{with_camera(), {.camera = {}, .width = 8, .height = 8}};
};

TEST_F(EmptyScene, PartsCanBeAddedAndRemoved) {
  const Index material = scene_.add_material(Material{});
  const Index mesh = scene_.add_mesh(triangle(material));
  const Index node = scene_.add_node(node_of(mesh));
  EXPECT_EQ(scene_.commit_edits(), Change::any);
  EXPECT_EQ(scene_.commit_edits(), Change::none);
  EXPECT_TRUE(meets(scene_, 0.2f, 0.2f));
  scene_.set_transform(node, {.translation = {5, 0, 0}});
  EXPECT_FALSE(meets(scene_, 0.2f, 0.2f));
  EXPECT_TRUE(meets(scene_, 5.2f, 0.2f));
  EXPECT_EQ(scene_.remove_node(node), std::vector<Index>{node});
  scene_.commit_edits();
  EXPECT_FALSE(meets(scene_, 5.2f, 0.2f));
}

/// Lights at infinity come last.
TEST(CompiledScene, TellsThatLightsWereRenumbered) {
  Scene scene = find_builtin_scene("cornell")->build();
  PunctualLight light{"lamp", PunctualType::point, Rgb(1)};
  scene.lights.push_back(light);
  const auto index = static_cast<Index>(scene.lights.size()) - 1;
  Node node;
  node.light = index;
  scene.add_node(node);
  CompiledScene compiled(std::move(scene), {.camera = {}, .width = 8, .height = 8});
  light.type = PunctualType::spot;
  EXPECT_EQ(compiled.set_light(index, light), Change::lights);
  light.type = PunctualType::directional;
  EXPECT_EQ(compiled.set_light(index, light), Change::lights | Change::light_list);
}

TEST_F(EmptyScene, NodesMayShareMeshesAndHaveChildren) {
  const Index mesh = scene_.add_mesh(triangle(kNone));
  const Index above = scene_.add_node(node_of(mesh));
  Node below = node_of(mesh);
  below.parent = above;
  below.transform.translation = {3, 0, 0};
  const Index child = scene_.add_node(below);
  scene_.commit_edits();
  scene_.set_transform(above, {.translation = {0, 4, 0}});
  EXPECT_TRUE(meets(scene_, 0.2f, 4.2f));
  EXPECT_TRUE(meets(scene_, 3.2f, 4.2f));
  EXPECT_THROW(scene_.remove_mesh(mesh), Error);
  EXPECT_EQ(scene_.remove_node(above), (std::vector<Index>{above, child}));
  EXPECT_NO_THROW(scene_.remove_mesh(mesh));
  EXPECT_THROW(scene_.add_node(node_of(mesh)), Error);
}

TEST_F(EmptyScene, NewMaterialsKeepTheDefault) {
  const Index plain = scene_.add_mesh(triangle(kNone));
  scene_.add_node(node_of(plain));
  Material red;
  red.base_color = Rgb(1, 0, 0);
  const Index material = scene_.add_material(red);
  scene_.add_node(node_of(scene_.add_mesh(triangle(material))));
  scene_.commit_edits();
  const SceneView& view = scene_.view();
  ASSERT_EQ(view.instances.size, 2u);
  EXPECT_EQ(view.materials[view.meshes[view.instances[0].mesh].material].base_color, Rgb(1));
  EXPECT_EQ(view.materials[view.meshes[view.instances[1].mesh].material].base_color, Rgb(1, 0, 0));
}

TEST_F(EmptyScene, DispersesOnlyWithAnInstanceOfADispersiveMaterial) {
  Material glass;
  glass.transmission = 1;
  glass.thickness = 1;
  glass.dispersion = 1;
  const Index material = scene_.add_material(glass);
  const Index mesh = scene_.add_mesh(triangle(material));
  scene_.commit_edits();
  EXPECT_FALSE(scene_.view().disperses);
  const Index node = scene_.add_node(node_of(mesh));
  scene_.commit_edits();
  EXPECT_TRUE(scene_.view().disperses);
  glass.dispersion = 0;
  scene_.set_material(material, glass);
  EXPECT_FALSE(scene_.view().disperses);
  glass.dispersion = 1;
  scene_.set_material(material, glass);
  EXPECT_TRUE(scene_.view().disperses);
  scene_.remove_node(node);
  scene_.commit_edits();
  EXPECT_FALSE(scene_.view().disperses);
}

TEST_F(EmptyScene, LightsShineOnceANodeHasThem) {
  const auto count = [&] { return scene_.view().lights.lights.size; };
  const uint32_t before = count();
  const Index light = scene_.add_light({.name = "bulb"});
  scene_.commit_edits();
  EXPECT_EQ(count(), before);
  Node node;
  node.light = light;
  const Index holder = scene_.add_node(node);
  scene_.commit_edits();
  EXPECT_EQ(count(), before + 1);
  EXPECT_THROW(scene_.remove_light(light), Error);
  scene_.remove_node(holder);
  scene_.commit_edits();
  EXPECT_EQ(count(), before);
  EXPECT_NO_THROW(scene_.remove_light(light));
}

TEST_F(EmptyScene, TheViewStaysIfItsCameraIsRemoved) {
  const CameraPose before = scene_.camera();
  scene_.remove_node(0);
  scene_.commit_edits();
  EXPECT_EQ(scene_.camera().to_world, before.to_world);
}

TEST_F(EmptyScene, RejectsInvalidPartsWithoutChange) {
  EXPECT_THROW(scene_.add_mesh(triangle(7)), Error);
  Mesh broken = triangle(kNone);
  broken.triangles = {{0, 1, 9}};
  EXPECT_THROW(scene_.add_mesh(broken), Error);
  EXPECT_THROW(scene_.add_node(node_of(0)), Error);
  Node far = {};
  far.light = scene_.add_light({});
  far.transform.translation = {2 * 1e9f, 0, 0};
  EXPECT_THROW(scene_.add_node(far), Error);
  Node orphan;
  orphan.parent = 12;
  EXPECT_THROW(scene_.add_node(orphan), Error);
  EXPECT_EQ(scene_.source().nodes.size(), 1u);
}

TEST(CompiledSceneEdit, StaticMeshesCannotBeShared) {
  CompiledScene scene(find_builtin_scene("cornell")->build(), {.camera = {}, .width = 8, .height = 8});
  EXPECT_THROW(scene.add_node(node_of(0)), Error);
}

}  // namespace
}  // namespace relume
