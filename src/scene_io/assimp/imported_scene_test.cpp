#include "scene_io/assimp/imported_scene.h"

#include <random>

#include <gtest/gtest.h>

#include "relume/error.h"
#include "scene/scene_hash.h"

namespace relume {
namespace {

/// A scene with a value in every field.
ImportedScene rich() {
  ImportedScene imported;
  Scene& scene = imported.scene;
  scene.name = "a";
  Material& material = scene.materials.emplace_back();
  material.name = "paint";
  material.base_color = Rgb(0.1f, 0.2f, 0.3f);
  material.emission_texture = {0, 1, Vec2(1, 2), Vec2(3, 4), 5};
  material.alpha_mode = AlphaMode::blend;
  material.double_sided = true;
  material.clearcoat_roughness = 0.25f;
  material.microfacet_model = MicrofacetModel::beckmann;
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.name = "plate";
  mesh.positions = {Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  mesh.normals.assign(3, Vec3(0, 0, 1));
  mesh.tangents.assign(3, Vec4(1, 0, 0, -1));
  mesh.uv0 = {Vec2(0), Vec2(1, 0), Vec2(0, 1)};
  mesh.uv1 = {Vec2(0), Vec2(2, 0), Vec2(0, 2)};
  mesh.colors.assign(3, Vec4(0.5f));
  mesh.triangles = {UVec3(0, 1, 2)};
  mesh.material = 0;
  scene.lights.push_back({"lamp", PunctualType::spot, Rgb(1, 2, 3), 0.1f, 0.2f, 0.3f});
  scene.cameras.push_back({"view", Projection::orthographic, 0.5f, 2, 3, 4});
  Node& node = scene.nodes.emplace_back();
  node.name = "root";
  node.transform.translation = Vec3(1, 2, 3);
  node.matrix = Mat4(2);
  node.meshes = {0};
  node.instances = {Mat4(1), Mat4(3)};
  Node& child = scene.nodes.emplace_back();
  child.name = "child";
  child.parent = child.light = child.camera = 0;
  scene.warnings = {"a: one", "a: two"};
  imported.textures = {{TextureRecipe::normal, WrapMode::mirror, WrapMode::clamp, "*0", "b.png"}};
  imported.embedded["*0"] = {1, 1, Bytes(4, std::byte{7})};
  imported.texture_lamps = {0};
  imported.files = {"a.obj", "b.mtl"};
  return imported;
}

TEST(ImportedScene, RoundTripsThroughBytes) {
  const ImportedScene before = rich();
  const Bytes bytes = serialise(before);
  const ImportedScene after = deserialise(bytes, "a");
  EXPECT_EQ(scene_hash(after.scene), scene_hash(before.scene));
  EXPECT_EQ(after.scene.warnings, before.scene.warnings);
  EXPECT_EQ(after.scene.nodes.at(1).name, "child");
  EXPECT_FALSE(after.scene.nodes[1].matrix);
  EXPECT_EQ(after.scene.materials.at(0).microfacet_model, MicrofacetModel::beckmann);
  EXPECT_EQ(after.textures.at(0).second, "b.png");
  EXPECT_EQ(after.embedded.at("*0").bytes, Bytes(4, std::byte{7}));
  EXPECT_EQ(after.files, before.files);
  EXPECT_EQ(serialise(after), bytes);
  EXPECT_EQ(
      deserialise(
          serialise(
              {.problem = "a: damaged", .scene = {}, .textures = {}, .embedded = {}, .texture_lamps = {}, .files = {}}),
          "a")
          .problem,
      "a: damaged");
}

TEST(ImportedScene, RefusesBytesThatEndEarly) {
  const Bytes bytes = serialise(rich());
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(deserialise({bytes.data(), size}, "a"), Error) << size;
  Bytes longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_THROW(deserialise(longer, "a"), Error);
}

TEST(ImportedScene, SurvivesBytesOfAnyValue) {
  const Bytes bytes = serialise(rich());
  uint32_t refused = 0;
  for (size_t at = 0; at < bytes.size(); ++at) {
    for (const int value : {0x00, 0x01, 0x7f, 0x80, 0xff}) {
      Bytes changed = bytes;
      changed[at] = static_cast<std::byte>(value);
      try {
        deserialise(changed, "a");
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100u);
}

TEST(ImportedScene, RefusesReferencesOutOfRange) {
  ImportedScene texture = rich();
  texture.scene.materials[0].normal_texture.texture = 1;
  EXPECT_THROW(deserialise(serialise(texture), "a"), Error);
  ImportedScene lamp = rich();
  lamp.texture_lamps = {1};
  EXPECT_THROW(deserialise(serialise(lamp), "a"), Error);
  lamp.texture_lamps = {-1};
  EXPECT_THROW(deserialise(serialise(lamp), "a"), Error);
}

}  // namespace
}  // namespace relume
