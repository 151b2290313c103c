// Tests import and export of skins, morph targets, visibility and clips.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "files/testing/temp_folder.h"
#include "relume/scene_io.h"
#include "scene/scene_hash.h"
#include "scene_io/testing/figure_file.h"
#include "scene_io/testing/written_gltf.h"

namespace relume {
namespace {

using testing::error_of;
using testing::Figure;
using testing::json;
using testing::kUnsignedByte;
using testing::mentions;

const Node& body(const Scene& scene) {
  return *std::find_if(scene.nodes.begin(), scene.nodes.end(), [](const Node& n) { return n.name == "body"; });
}

TEST(GltfSkins, AreRead) {
  Figure figure;
  const Scene scene = figure.file.load();
  ASSERT_EQ(scene.skins.size(), 1u);
  const Skin& skin = scene.skins[0];
  ASSERT_EQ(skin.joints.size(), 2u);
  EXPECT_EQ(scene.nodes[static_cast<size_t>(skin.joints[1])].name, "upper");
  EXPECT_EQ(skin.inverse_bind[1][3], Vec4(0, -1, 0, 1));
  EXPECT_EQ(body(scene).skin, 0);
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.influences_per_vertex, 4);
  EXPECT_EQ(mesh.influences[1].joint, 1u);
  EXPECT_EQ(mesh.influences[1].weight, 0.25f);
  EXPECT_EQ(mesh.influences[4].joint, 1u);
  EXPECT_EQ(mesh.influences[4].weight, 1.0f);  // normalised from 2
  EXPECT_EQ(mesh.influences[8].weight, 1.0f);  // normalised from 0
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
}

TEST(GltfSkins, TakeSeveralSetsOfJoints) {
  Figure figure;
  json& attributes = figure.file.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_1"] = attributes["JOINTS_0"];
  attributes["WEIGHTS_1"] = attributes["WEIGHTS_0"];
  const Scene scene = figure.file.load();
  ASSERT_EQ(scene.meshes[0].influences_per_vertex, 8);
  EXPECT_EQ(scene.meshes[0].influences[5].joint, 1u);
  EXPECT_EQ(scene.meshes[0].influences[5].weight, 0.125f);
}

TEST(GltfSkins, MorphTargetsAreRead) {
  Figure figure;
  const Scene scene = figure.file.load();
  ASSERT_EQ(scene.meshes[0].morph_targets.size(), 2u);
  EXPECT_EQ(scene.meshes[0].morph_targets[0].name, "up");
  EXPECT_EQ(scene.meshes[0].morph_targets[1].positions[2], Vec3(3, 0, 0));
  EXPECT_EQ(body(scene).morph_weights, (std::vector<float>{0.5f, 0}));
  figure.file.doc["nodes"][static_cast<size_t>(figure.node)]["weights"] = {0, 2};
  const Scene own = figure.file.load();
  EXPECT_EQ(body(own).morph_weights, (std::vector<float>{0, 2}));
}

TEST(GltfSkins, WeightsAreAnimatedInEveryInterpolation) {
  Figure figure;
  figure.animate(figure.node, "weights", {0, 1}, {0, 0, 1, 2}, 1, "linear");
  figure.animate(figure.node, "weights", {0, 1}, {0, 0, 1, 2}, 1, "step", "STEP");
  figure.animate(figure.node, "weights", {0, 1}, {0, 0, 0, 0, 8, 0, 0, -4, 1, 2, 0, 0}, 1, "spline", "CUBICSPLINE");
  const Scene scene = figure.file.load();
  EXPECT_EQ(scene.clips, (std::vector<std::string>{"linear", "step", "spline"}));
  ASSERT_EQ(scene.animation.size(), 6u);
  const auto weights = [&](const std::string& clip) {
    Scene playing = scene;
    select_animation(playing, clip);
    return morph_weights(playing, static_cast<Index>(&body(scene) - scene.nodes.data()), 0.5f);
  };
  EXPECT_EQ(weights("linear"), (std::vector<float>{0.5f, 1}));
  EXPECT_EQ(weights("step"), (std::vector<float>{0, 0}));
  // At the midpoint, a spline adds an eighth of its first tangent and subtracts an eighth of its last.
  EXPECT_EQ(weights("spline"), (std::vector<float>{0.5f + 1, 1 + 0.5f}));
}

TEST(GltfSkins, VisibilityIsReadAndAnimated) {
  Figure figure;
  figure.file.doc["nodes"][static_cast<size_t>(figure.node)]["extensions"]["KHR_node_visibility"] = {
      {"visible", false}};
  const int shown = figure.file.accessor(std::vector<uint8_t>{0, 1}, 1, kUnsignedByte);
  const std::string pointer = "/nodes/" + std::to_string(figure.node) + "/extensions/KHR_node_visibility/visible";
  figure.file.add(
      "animations",
      {{"samplers", {{{"input", figure.file.floats({0, 2}, 1)}, {"output", shown}}}},
       {"channels",
        {{{"sampler", 0},
          {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}}}}});
  const Scene scene = figure.file.load();
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
  EXPECT_FALSE(body(scene).visible);
  const auto index = static_cast<size_t>(&body(scene) - scene.nodes.data());
  EXPECT_FALSE(visible_nodes(scene, 1.9f)[index]);
  EXPECT_TRUE(visible_nodes(scene, 2)[index]);
}

TEST(GltfSkins, FlawsKeepTheRestPose) {
  const auto warnings = [](const std::function<void(Figure&)>& damage) {
    Figure figure;
    damage(figure);
    return figure.file.load().warnings;
  };
  EXPECT_TRUE(mentions(warnings([](Figure& f) { f.file.doc["skins"][0]["joints"] = json::array(); }), "has no joints"));
  EXPECT_TRUE(
      mentions(warnings([](Figure& f) { f.file.doc["skins"][0]["joints"][1] = f.file.add("nodes", json::object()); }),
               "outside of the scene"));
  EXPECT_TRUE(mentions(warnings([](Figure& f) {
                         json& attributes = f.file.doc["meshes"][0]["primitives"][0]["attributes"];
                         attributes["JOINTS_0"] = f.file.accessor(std::vector<uint8_t>(12, 200), 4, kUnsignedByte);
                       }),
                       "its mesh follows joints that skin 'bones' lacks"));
  EXPECT_TRUE(
      mentions(warnings([](Figure& f) {
                 f.file.doc["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = f.file.floats({1, 2, 3}, 3);
               }),
               "of a morph target (1 elements) does not fit its 3 vertices"));
  EXPECT_TRUE(mentions(warnings([](Figure& f) {
                         f.file.doc["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = f.file.floats({1}, 1);
                       }),
                       "JOINTS_0 and WEIGHTS_0 do not fit its 3 vertices"));
  const auto error = [](const std::function<void(Figure&)>& damage) {
    Figure figure;
    damage(figure);
    return error_of([&] { figure.file.load(); });
  };
  EXPECT_NE(error([](Figure& f) { f.file.doc["skins"][0]["joints"][1] = 77; }).find("joint 77, which does not exist"),
            std::string::npos);
  EXPECT_NE(error([](Figure& f) { f.file.doc["nodes"][2]["skin"] = 5; }).find("skin 5, which does not exist"),
            std::string::npos);
  EXPECT_NE(error([](Figure& f) {
              f.file.doc["accessors"][f.file.doc["skins"][0]["inverseBindMatrices"].get<size_t>()]["count"] = 1;
            }).find("2 joints but 1 inverse bind matrices"),
            std::string::npos);
  EXPECT_NE(error([](Figure& f) {
              f.animate(f.node, "weights", {0, 1}, {0, 1}, 1, "short");
            }).find("animation 'short' has 2 times but 2 values"),
            std::string::npos);
}

TEST(GltfSkins, WritingAndReadingGivesTheSameScene) {
  Figure figure;
  figure.animate(figure.node, "weights", {0, 1}, {0, 0, 0, 0, 8, 0, 0, -4, 1, 2, 0, 0}, 1, "spline", "CUBICSPLINE");
  figure.animate(0, "rotation", {0, 1}, {0, 0, 0, 1, 0, 1, 0, 0}, 4, "turn");
  Scene scene = figure.file.load();
  scene.nodes[0].visible = false;
  scene.animation.push_back(
      {0, AnimatedProperty::visible, Interpolation::step, {0, 1}, {Vec4(0), Vec4(1, 0, 0, 0)}, 0, 1});
  const TempFolder folder;
  for (const char* name : {"a.gltf", "a.glb"}) {
    EXPECT_TRUE(write_gltf(folder / name, scene).empty());
    const Scene again = load_scene(folder / name);
    EXPECT_EQ(again.clips, scene.clips);
    EXPECT_EQ(again.meshes[0].morph_targets[1].name, "right");
    EXPECT_EQ(scene_hash(again), scene_hash(scene));
  }
  testing::expect_sound_accessors(testing::written_json(folder / "a.gltf"), file_size(folder / "a.bin"));
}

TEST(GltfSkins, SparseMorphTargetsAreRead) {
  Figure figure;
  const int empty = figure.file.floats(std::vector<float>(9, 0.0f), 3);
  json& accessor = figure.file.doc["accessors"][static_cast<size_t>(empty)];
  accessor["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", figure.file.view(std::vector<uint16_t>{2})}, {"componentType", 5123}}},
      {"values", {{"bufferView", figure.file.view(std::vector<float>{7, 8, 9})}}}};
  accessor.erase("bufferView");
  figure.file.doc["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = empty;
  const Scene scene = figure.file.load();
  EXPECT_EQ(scene.meshes[0].morph_targets[0].positions, (std::vector<Vec3>{Vec3(0), Vec3(0), Vec3(7, 8, 9)}));
}

TEST(GltfSkins, SkinsOfOtherSizesLeaveASharedMeshAlone) {
  Figure figure;
  const int lower = figure.file.doc["skins"][0]["joints"][0];
  const int small = figure.file.add("skins", {{"joints", {lower}}});
  figure.file.add_root({{"name", "other"}, {"mesh", figure.mesh}, {"skin", small}});
  const Scene scene = figure.file.load();
  EXPECT_EQ(body(scene).skin, 0);
  EXPECT_EQ(scene.nodes.back().skin, kNone);
  EXPECT_EQ(scene.meshes[0].influences[1].joint, 1u);
  EXPECT_TRUE(mentions(scene.warnings, "node 'other': its mesh follows joints"));
}

TEST(GltfSkins, ClipsWithoutMotionAreOmitted) {
  Figure figure;
  figure.animate(figure.node, "fur", {0, 1}, {0, 1}, 1, "odd");
  figure.animate(0, "scale", {0, 1}, {1, 1, 1, 2, 2, 2}, 3, "grow");
  const Scene scene = figure.file.load();
  EXPECT_EQ(scene.clips, std::vector<std::string>{"grow"});
  EXPECT_EQ(scene.animation.at(0).clip, 0);
}

TEST(GltfSkins, RepeatedTargetsOfHostileFilesAreBounded) {
  Figure figure;
  json& accessors = figure.file.doc["accessors"];
  accessors.push_back({{"componentType", 5126}, {"count", 1 << 24}, {"type", "VEC3"}});
  const auto zeros = static_cast<int>(accessors.size()) - 1;
  json& primitive = figure.file.doc["meshes"][0]["primitives"][0];
  primitive["attributes"] = {{"POSITION", zeros}};
  primitive["targets"] = json::array();
  for (int i = 0; i < 100; ++i) primitive["targets"].push_back({{"POSITION", zeros}});
  EXPECT_NE(error_of([&] { figure.file.load(); }).find("take more than 8 GiB"), std::string::npos);
}

TEST(GltfSkins, ChannelsOfNoClipAreWrittenIntoEach) {
  Figure figure;
  figure.animate(0, "scale", {0, 1}, {1, 1, 1, 2, 2, 2}, 3, "grow");
  figure.animate(1, "scale", {0, 1}, {1, 1, 1, 2, 2, 2}, 3, "grow more");
  Scene scene = figure.file.load();
  scene.animation.push_back(
      {0, AnimatedProperty::translation, Interpolation::linear, {0, 1}, {Vec4(0), Vec4(1, 0, 0, 0)}, 0, kNone});
  const TempFolder folder;
  EXPECT_TRUE(write_gltf(folder / "a.gltf", scene).empty());
  const Scene again = load_scene(folder / "a.gltf");
  for (const char* clip : {"grow", "grow more"}) {
    Scene before = scene;
    Scene after = again;
    select_animation(before, clip);
    select_animation(after, clip);
    EXPECT_EQ(world_matrices(after, 0.5f), world_matrices(before, 0.5f)) << clip;
  }
}

TEST(GltfSkins, MorphTargetKeysAreMerged) {
  Figure figure;
  Scene scene = figure.file.load();
  const auto index = static_cast<Index>(&body(scene) - scene.nodes.data());
  const auto add = [&](Index target, std::vector<float> times) {
    AnimationChannel& channel = scene.animation.emplace_back();
    channel.node = index;
    channel.property = AnimatedProperty::morph_weight;
    channel.morph_target = target;
    for (const float t : times) channel.values.emplace_back(t, 0.0f, 0.0f, 0.0f);
    channel.times = std::move(times);
  };
  add(0, {0, 2});
  add(1, {0, 1, 2});
  const TempFolder folder;
  EXPECT_TRUE(mentions(write_gltf(folder / "a.gltf", scene), "keys at different times"));
  Scene again = load_scene(folder / "a.gltf");
  EXPECT_EQ(morph_weights(again, index, 0.5f), (std::vector<float>{0.5f, 0.5f}));
}

}  // namespace
}  // namespace relume
