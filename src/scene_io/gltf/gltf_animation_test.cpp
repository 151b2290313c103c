// Tests glTF animation, cameras, lights and instances.
#include <gtest/gtest.h>

#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::error_of;
using testing::GltfBuilder;
using testing::json;
using testing::mentions;

void add_channel(GltfBuilder& file, int node, const char* path, int input, int output, const char* interpolation) {
  file.add("animations", {{"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
                          {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}}});
}

TEST(GltfAnimation, ReadsAllPropertiesAndInterpolations) {
  GltfBuilder file;
  const int node = file.add_root(json::object());
  const int times = file.floats({0, 2}, 1);
  add_channel(file, node, "translation", times, file.floats({0, 0, 0, 4, 2, 0}, 3), "LINEAR");
  add_channel(file, node, "rotation", times,
              file.accessor(std::vector<int16_t>{0, 0, 0, 32767, 0, 32767, 0, 0}, 4, 5122, true), "STEP");
  add_channel(file, node, "scale", times, file.floats({0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 3, 3, 3, 0, 0, 0}, 3),
              "CUBICSPLINE");
  const Scene scene = file.load();
  ASSERT_EQ(scene.animation.size(), 3u);
  EXPECT_EQ(scene.animation[0].values[1], Vec4(4, 2, 0, 0));
  EXPECT_EQ(scene.animation[1].interpolation, Interpolation::step);
  EXPECT_EQ(scene.animation[1].values[1], Vec4(0, 1, 0, 0));
  EXPECT_EQ(scene.animation[2].interpolation, Interpolation::cubic_spline);
  EXPECT_EQ(scene.animation[2].values.size(), 6u);
  const Mat4 middle = world_matrices(scene, 1)[0];
  EXPECT_EQ(Vec3(middle[3]), Vec3(2, 1, 0));
  EXPECT_FLOAT_EQ(middle[0].x, 2.0f);  // a spline without tangents reaches the midpoint at half time
}

TEST(GltfAnimation, DecomposesAnimatedMatrices) {
  GltfBuilder file;
  const int node = file.add_root({{"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1}}});
  add_channel(file, node, "translation", file.floats({0, 1}, 1), file.floats({0, 0, 0, 1, 0, 0}, 3), "LINEAR");
  const Scene scene = file.load();
  EXPECT_FALSE(scene.nodes[0].matrix.has_value());
  EXPECT_EQ(scene.nodes[0].transform.scale, Vec3(2));
  EXPECT_EQ(Vec3(world_matrices(scene, 1)[0][3]), Vec3(1, 0, 0));
}

TEST(GltfAnimation, RepairsAndRefuses) {
  GltfBuilder file;
  const int node = file.add_root(json::object());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  add_channel(file, node, "translation", file.floats({0, 1, 1, 2, nan}, 1),
              file.floats({0, 0, 0, 1, 0, 0, 9, 9, 9, 2, 0, 0, 9, 9, 9}, 3), "LINEAR");
  json& channels = file.doc["animations"][0]["channels"];
  channels.push_back(channels[0]);
  add_channel(file, node, "weights", file.floats({0, 1}, 1), file.floats({0, 1}, 1), "LINEAR");
  const Scene scene = file.load();
  ASSERT_EQ(scene.animation.size(), 1u);
  EXPECT_EQ(scene.animation[0].times, (std::vector<float>{0, 1, 2}));
  EXPECT_EQ(scene.animation[0].values[2], Vec4(2, 0, 0, 0));
  EXPECT_TRUE(mentions(scene.warnings, "moves morph targets that do not exist"));
  EXPECT_TRUE(mentions(scene.warnings, "has several channels for a property of node 'node 0'"));
  add_channel(file, node, "scale", file.floats({0, 1, 2}, 1), file.floats({0, 0, 0, 1, 0, 0}, 3), "LINEAR");
  EXPECT_NE(error_of([&] { file.load(); }).find("3 times but 2 values"), std::string::npos);
}

TEST(GltfCamera, ReadsBothKinds) {
  GltfBuilder file;
  file.add("cameras", {{"type", "perspective"}, {"name", "a"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  file.add("cameras",
           {{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 10}}}});
  file.add_root({{"camera", 0}});
  file.add_root({{"camera", 1}});
  file.add_root({{"camera", 8}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.cameras[0].name, "a");
  EXPECT_EQ(scene.cameras[0].fov_y_rad, 0.5f);
  EXPECT_EQ(scene.cameras[1].projection, Projection::orthographic);
  EXPECT_EQ(scene.cameras[1].half_height, 2.0f);
  EXPECT_EQ(scene.nodes[1].camera, 1);
  EXPECT_EQ(scene.nodes[2].camera, kNone);
  EXPECT_EQ(scene.cameras[1].aspect_ratio, 1.5f);
}

TEST(GltfCamera, HasTheShapeThatItsFileGives) {
  const auto aspect_ratio = [](double ratio) {
    GltfBuilder file;
    file.add("cameras", {{"type", "perspective"},
                         {"name", "a"},
                         {"perspective", {{"yfov", 0.5}, {"znear", 0.1}, {"aspectRatio", ratio}}}});
    file.add_root({{"camera", 0}});
    const Scene scene = file.load();
    EXPECT_TRUE(scene.warnings.empty());
    return scene.cameras[0].aspect_ratio;
  };
  EXPECT_EQ(aspect_ratio(1.5), 1.5f);
  EXPECT_EQ(aspect_ratio(1e6), 0.0f);
}

TEST(GltfLights, ReadsAllTypes) {
  GltfBuilder file;
  file.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0.25}}, {"intensity", 40}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}},
      {{"type", "directional"}, {"name", "sun"}, {"intensity", 3}, {"color", {1, 1, 1}}}};
  for (int i = 0; i < 4; ++i) file.add_root({{"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_EQ(scene.lights[0].type, PunctualType::point);
  EXPECT_EQ(scene.lights[0].intensity, Rgb(40, 20, 10));
  EXPECT_EQ(scene.lights[1].type, PunctualType::spot);
  EXPECT_EQ(scene.lights[1].intensity, Rgb(1));
  EXPECT_EQ(scene.lights[1].inner_cone_rad, 0.1f);
  EXPECT_EQ(scene.lights[1].outer_cone_rad, 0.2f);
  EXPECT_EQ(scene.lights[2].type, PunctualType::directional);
  EXPECT_EQ(scene.lights[2].name, "sun");
  EXPECT_EQ(scene.nodes[2].light, 2);
  EXPECT_EQ(scene.nodes[3].light, kNone);
  EXPECT_TRUE(mentions(scene.warnings, "light 3"));
}

TEST(GltfLights, ClampsOutOfRangeValuesWithAWarning) {
  GltfBuilder file;
  file.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"name", "needle"}, {"type", "spot"}, {"spot", {{"outerConeAngle", 0}}}},
      {{"name", "wide"}, {"type", "spot"}, {"spot", {{"outerConeAngle", 3}}}},
      {{"name", "nova"}, {"type", "point"}, {"intensity", 1e30}},
      {{"name", "plain"}, {"type", "spot"}, {"spot", json::object()}}};
  for (int i = 0; i < 4; ++i) file.add_root({{"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.lights.size(), 4u);
  EXPECT_EQ(scene.lights[0].outer_cone_rad, 1e-3f);
  EXPECT_EQ(scene.lights[1].outer_cone_rad, kPi / 2);
  EXPECT_EQ(scene.lights[2].intensity, Rgb(kMaxRadiance));
  EXPECT_TRUE(mentions(scene.warnings, "'needle': its outer cone angle is out of range"));
  EXPECT_TRUE(mentions(scene.warnings, "'wide': its outer cone angle is out of range"));
  EXPECT_TRUE(mentions(scene.warnings, "'nova': its intensity"));
  EXPECT_FALSE(mentions(scene.warnings, "plain"));
}

TEST(GltfInstancing, ReadsMatrices) {
  GltfBuilder file;
  const json attributes = {{"TRANSLATION", file.floats({1, 2, 3, 4, 5, 6}, 3)},
                           {"SCALE", file.floats({1, 1, 1, 2, 2, 2}, 3)}};
  file.add_root(
      {{"mesh", file.add_triangle()}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.nodes[0].instances.size(), 2u);
  EXPECT_EQ(Vec3(scene.nodes[0].instances[1][3]), Vec3(4, 5, 6));
  EXPECT_EQ(scene.nodes[0].instances[1][0].x, 2.0f);
}

}  // namespace
}  // namespace relume
