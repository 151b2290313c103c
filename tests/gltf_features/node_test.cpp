// Tests node placement (EXT_mesh_gpu_instancing, hierarchies, animation) and file containers.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "gltf_features/stage.h"
#include "relume/scene_io.h"

namespace relume::support {
namespace {

/// Adds a glossy card with a texture and a normal map, facing +Z.
int add_card(Stage& stage) {
  const json material = {
      {"pbrMetallicRoughness",
       {{"baseColorTexture", stage.texture(4, 4, colorful(4, 4))}, {"metallicFactor", 0.3}, {"roughnessFactor", 0.6}}},
      {"normalTexture", stage.texture(1, 2, {170, 128, 240, 255, 90, 150, 240, 255})}};
  json attributes = stage.square();
  attributes["NORMAL"] = stage.file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  return stage.mesh(attributes, material);
}

/// Positions of three cards that roughly face the camera and do not overlap.
struct Place {
  std::array<float, 3> translation;
  float turn;  ///< about Y, radians
  std::array<float, 3> scale;
};
const std::array<Place, 3> kPlaces = {{{{-0.5f, 0.5f, 0}, 0.5f, {0.4f, 0.4f, 0.4f}},
                                       {{0.5f, 0.4f, 0.3f}, -0.3f, {0.3f, 0.5f, 1}},
                                       {{0, -0.5f, 0}, 0, {0.8f, 0.3f, 1}}}};

json node_at(const Place& place) {
  return {
      {"translation", place.translation}, {"rotation", rotation_json({0, 1, 0}, place.turn)}, {"scale", place.scale}};
}

/// One node with instances against separate nodes, below a rotating parent.
Scene instancing(Way way) {
  Stage stage;
  const int mesh = add_card(stage);
  json children = json::array();
  if (way == Way::plain) {
    for (const Place& place : kPlaces) {
      json node = node_at(place);
      node["mesh"] = mesh;
      children.push_back(stage.file.add("nodes", node));
    }
  } else {
    json node = {{"mesh", mesh}};
    std::vector<float> translations;
    std::vector<float> rotations;
    std::vector<float> scales;
    for (const Place& place : kPlaces) {
      translations.insert(translations.end(), place.translation.begin(), place.translation.end());
      for (const json& c : rotation_json({0, 1, 0}, place.turn)) rotations.push_back(c.get<float>());
      scales.insert(scales.end(), place.scale.begin(), place.scale.end());
    }
    if (way == Way::feature) {
      node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
          {"TRANSLATION", stage.file.floats(translations, 3)},
          {"ROTATION", stage.file.floats(rotations, 4)},
          {"SCALE", stage.file.floats(scales, 3)}};
    }
    children.push_back(stage.file.add("nodes", node));
  }
  stage.file.add_root({{"children", children}, {"rotation", rotation_json({0, 0, 1}, 0.3f)}});
  stage.sun();
  return stage.load();
}

/// Moving nodes are instances of one mesh; textures and normal maps match those of static nodes. Uses direct light
/// only: indirect rays use coarse texture levels, which are dithered by the last bits of coordinates.
Scene moving_instances(Way way) {
  Stage stage;
  const int mesh = add_card(stage);
  for (const Place& place : kPlaces) {
    json node = node_at(place);
    node["mesh"] = mesh;
    if (way != Way::plain) node["translation"][0] = place.translation[0] - 0.7f;
    const int index = stage.file.add_root(node);
    if (way != Way::feature) continue;
    const auto& [x, y, z] = place.translation;
    stage.animate(index, "translation", {0, 1}, {x - 0.7f, y, z, x + 0.7f, y, z}, 3);  // at its position after 0.5 s
  }
  stage.sun();
  return stage.load();
}

/// A card that an animation moves to its position in the other scene.
Scene animated(Way way, const json& place, const char* path, const std::vector<float>& times,
               const std::vector<float>& values, const char* interpolation) {
  Stage stage;
  json node = way == Way::plain ? place : json::object();
  if (!node.contains("scale")) node["scale"] = {0.6, 0.6, 0.6};
  node["mesh"] = add_card(stage);
  const int index = stage.file.add_root(node);
  const int components = std::string_view(path) == "rotation" ? 4 : 3;
  if (way == Way::feature) stage.animate(index, path, times, values, components, interpolation);
  stage.sun();
  return stage.load();
}

// Half a second into the animation:
Scene linear_translation(Way way) {
  return animated(way, {{"translation", {0.3, -0.2, 0}}}, "translation", {0, 2}, {0, 0, 0, 1.2f, -0.8f, 0}, "LINEAR");
}
Scene step_scale(Way way) {
  return animated(way, {{"scale", {0.5, 0.9, 1}}}, "scale", {0, 0.25f, 0.75f}, {1, 1, 1, 0.5f, 0.9f, 1, 2, 2, 2},
                  "STEP");
}
Scene linear_rotation(Way way) {  // along the great circle: a quarter of 2 radians
  return animated(way, {{"rotation", rotation_json({0, 0, 1}, 0.5f)}}, "rotation", {0, 2},
                  {0, 0, 0, 1, 0, 0, std::sin(1.0f), std::cos(1.0f)}, "LINEAR");
}
Scene cubic_translation(Way way) {  // halfway between 0 and 0.5 with slopes 0.8 and 0.4: 0.25 + (0.8 - 0.4) / 8
  return animated(way, {{"translation", {0.3, 0, 0}}}, "translation", {0, 1},
                  {0, 0, 0, 0, 0, 0, 0.8f, 0, 0, 0.4f, 0, 0, 0.5f, 0, 0, 0, 0, 0}, "CUBICSPLINE");
}

const FeatureCase kCases[] = {
    {"GpuInstancing", instancing, 1e-3},          {"MovingInstances", moving_instances, 1e-3, 1},
    {"AnimatedLinear", linear_translation, 1e-3}, {"AnimatedStep", step_scale, 1e-3},
    {"AnimatedRotation", linear_rotation, 1e-3},  {"AnimatedCubic", cubic_translation, 1e-3},
};

class NodeFeature : public FeatureTest {};
TEST_P(NodeFeature, MatchesPlainScene) { check(); }
INSTANTIATE_TEST_SUITE_P(Gltf, NodeFeature, ::testing::ValuesIn(kCases), feature_name);

/// One scene with its bytes in data URIs, in separate files, and in a GLB.
class Containers : public ::testing::Test {
 protected:
  Containers() {
    stage_.show(stage_.square(), unlit_json(stage_.texture(4, 4, colorful(4, 4))));
    json& image = stage_.file.doc["images"][0];
    const Bytes png = testing::png(4, 4, colorful(4, 4));
    image = {{"uri", "data:image/png;base64," + testing::encode_base64(png)}};
    name_extensions(stage_.file.doc);
  }

  Image expected() const { return image(testing::load_text(stage_.file.text())); }
  static Image read(const std::filesystem::path& file) {
    Scene scene = load_scene(file);
    EXPECT_TRUE(scene.warnings.empty());
    return image(std::move(scene));
  }

  Stage stage_;
  testing::SceneFolder folder_;
};

TEST_F(Containers, DataUris) {
  expect_pixels(expected(), 1e-5, [](double x, double y) {
    const std::vector<uint8_t> texels = colorful(4, 4);
    const size_t texel = 4 * (static_cast<size_t>((1 - y) * 2) * 4 + static_cast<size_t>((x + 1) * 2));
    return Rgb(linear_of(texels[texel]), linear_of(texels[texel + 1]), linear_of(texels[texel + 2]));
  });
  expect_same(read(folder_.write("a.gltf", stage_.file.text())), expected(), 0);
}

TEST_F(Containers, FilesBesideIt) {
  json doc = json::parse(stage_.file.text());
  doc["buffers"][0]["uri"] = "some%20data.bin";
  doc["images"][0]["uri"] = "maps/image.png";
  const std::filesystem::path file = folder_.write("a.gltf", doc.dump());
  const Bytes glb = stage_.file.glb();  // exactly to the end of the buffer
  const size_t size = doc["buffers"][0]["byteLength"];
  folder_.write("some data.bin", Bytes(glb.end() - static_cast<std::ptrdiff_t>(size + (4 - size % 4) % 4), glb.end()));
  std::filesystem::create_directories(folder_.path() / "maps");
  folder_.write("maps/image.png", testing::png(4, 4, colorful(4, 4)));
  expect_same(read(file), expected(), 0);
}

TEST_F(Containers, Glb) { expect_same(read(folder_.write("a.glb", stage_.file.glb())), expected(), 0); }

TEST_F(Containers, GlbWithTheImageInside) {
  stage_.file.doc["images"][0] = {{"bufferView", 0}, {"mimeType", "image/png"}};
  stage_.file.doc["images"][0]["bufferView"] = stage_.file.add_view(testing::png(4, 4, colorful(4, 4)));
  const Image inside = read(folder_.write("a.glb", stage_.file.glb()));
  expect_same(inside, expected(), 0);
}

}  // namespace
}  // namespace relume::support
