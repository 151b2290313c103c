// KHR_animation_pointer, read and written.
#include "scene_io/gltf/gltf_pointers.h"

#include <gtest/gtest.h>

#include "files/testing/temp_folder.h"
#include "relume/scene_io.h"
#include "scene/scene_hash.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using gltf::parse_parameter_pointer;
using gltf::pointer_parameters;
using gltf::pointer_to;
using testing::GltfBuilder;
using testing::json;
using testing::mentions;

/// A triangle with one material, a camera and a light, and an animation of pointers.
struct Stage {
  GltfBuilder file;
  json samplers = json::array();
  json channels = json::array();

  Stage() {
    file.add_triangle_with_material({{"emissiveFactor", {0.5, 0.5, 1}},
                                     {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}},
                                     {"alphaMode", "BLEND"},
                                     {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}});
    file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
    file.add_root({{"camera", 0}});
    file.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"}, {"color", {1, 0.5, 0.25}}, {"intensity", 8}, {"spot", {{"outerConeAngle", 0.7}}}}};
    file.add_root({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  }

  void animate(const std::string& pointer, const std::vector<float>& values, int components) {
    channels.push_back(
        {{"sampler", samplers.size()},
         {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
    samplers.push_back({{"input", file.floats({0, 2}, 1)}, {"output", file.floats(values, components)}});
  }

  Scene load() {
    file.doc["animations"] = {{{"name", "pulse"}, {"samplers", samplers}, {"channels", channels}}};
    return file.load();
  }
};

const ParameterChannel* find(const Scene& scene, const std::string& parameter) {
  for (const ParameterChannel& c : scene.parameter_animation) {
    if (c.parameter == parameter) return &c;
  }
  return nullptr;
}

TEST(GltfPointers, GoBothWays) {
  for (const gltf::PointerParameter& p : pointer_parameters()) {
    const std::string pointer = pointer_to(p, 12);
    const auto parsed = parse_parameter_pointer(pointer);
    ASSERT_TRUE(parsed) << pointer;
    EXPECT_EQ(parsed->index, 12);
    EXPECT_EQ(parsed->parameter->tail, p.tail);
  }
  EXPECT_TRUE(parse_parameter_pointer("/materials/0/extensions/KHR_materials_dispersion/dispersion"));
  for (const char* pointer : {"", "/", "/materials", "/materials/0", "/materials/x/alphaCutoff", "/materials/0/hue",
                              "/materials/99999999999/alphaCutoff", "/cameras/0/alphaCutoff", "/nodes/0/translation"})
    EXPECT_FALSE(parse_parameter_pointer(pointer)) << pointer;
}

TEST(GltfPointers, DriveMaterialsLightsAndCameras) {
  Stage stage;
  stage.animate("/materials/0/pbrMetallicRoughness/baseColorFactor", {1, 0, 0, 1, 0, 1, 0, 0}, 4);
  stage.animate("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset",
                {0, 0, 1, 2}, 2);
  stage.animate("/materials/0/extensions/KHR_materials_clearcoat/clearcoatFactor", {0, 1}, 1);
  stage.animate("/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle", {0.7f, 0.2f}, 1);
  stage.animate("/cameras/0/perspective/yfov", {0.5f, 1}, 1);
  const Scene scene = stage.load();
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
  EXPECT_EQ(scene.parameter_animation.size(), 6u);
  EXPECT_EQ(find(scene, "base_color")->values[1], Vec4(0, 1, 0, 0));
  EXPECT_EQ(find(scene, "alpha")->values[0].x, 1);
  EXPECT_EQ(find(scene, "base_color_texture.offset")->values[1], Vec4(1, 2, 0, 0));
  EXPECT_EQ(find(scene, "clearcoat")->part, AnimatedPart::material);
  EXPECT_EQ(find(scene, "outer_cone")->part, AnimatedPart::light);
  EXPECT_EQ(find(scene, "fov_y")->part, AnimatedPart::camera);
}

TEST(GltfPointers, ColoursAndStrengthsDriveTheirProduct) {
  Stage colors;
  colors.animate("/materials/0/emissiveFactor", {0, 0, 0, 1, 0.5f, 0}, 3);
  colors.animate("/extensions/KHR_lights_punctual/lights/0/color", {0, 0, 0, 1, 1, 1}, 3);
  const Scene by_color = colors.load();
  EXPECT_EQ(find(by_color, "emission")->values[1], Vec4(4, 2, 0, 0));
  EXPECT_EQ(find(by_color, "intensity")->values[1], Vec4(8, 8, 8, 0));
  Stage strengths;
  strengths.animate("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", {0, 2}, 1);
  strengths.animate("/extensions/KHR_lights_punctual/lights/0/intensity", {0, 4}, 1);
  const Scene by_strength = strengths.load();
  EXPECT_EQ(find(by_strength, "emission")->values[1], Vec4(1, 1, 2, 0));
  EXPECT_EQ(find(by_strength, "intensity")->values[1], Vec4(4, 2, 1, 0));
  strengths.animate("/materials/0/emissiveFactor", {0, 0, 0, 1, 0.5f, 0}, 3);
  EXPECT_TRUE(mentions(strengths.load().warnings, "has several channels for"));
}

TEST(GltfPointers, OthersAreIgnoredWithAWarning) {
  Stage stage;
  stage.animate("/materials/0/pbrMetallicRoughness/hue", {0, 1}, 1);
  stage.animate("/materials/7/alphaCutoff", {0, 1}, 1);
  const Scene scene = stage.load();
  EXPECT_TRUE(mentions(scene.warnings, "animation of '/materials/0/pbrMetallicRoughness/hue' is not supported"));
  EXPECT_TRUE(scene.parameter_animation.empty());
  EXPECT_TRUE(scene.clips.empty());
}

TEST(GltfPointers, WritingAndReadingGivesTheSameScene) {
  Stage stage;
  stage.animate("/materials/0/pbrMetallicRoughness/baseColorFactor", {1, 0, 0, 1, 0, 1, 0, 0}, 4);
  stage.animate("/materials/0/emissiveFactor", {0, 0, 0, 1, 0.5f, 0}, 3);
  stage.animate("/extensions/KHR_lights_punctual/lights/0/color", {0, 0, 0, 1, 1, 1}, 3);
  stage.animate("/cameras/0/perspective/yfov", {0.5f, 1}, 1);
  const Scene scene = stage.load();
  const TempFolder folder;
  EXPECT_TRUE(write_gltf(folder / "a.glb", scene).empty());
  EXPECT_EQ(scene_hash(load_scene(folder / "a.glb")), scene_hash(scene));
}

}  // namespace
}  // namespace relume
