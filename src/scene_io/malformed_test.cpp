// Checks that damaged files of every format give an Error or an image, without crash or hang. Seeds are fixed; the
// suite prints the number of mutations.
#include <chrono>
#include <functional>
#include <random>
#include <span>

#include <gtest/gtest.h>

#include "render/session.h"
#include "scene_io/assimp/assimp_loader.h"
#include "scene_io/gltf/gltf_loader.h"
#include "scene_io/mitsuba/mitsuba_loader.h"
#include "scene_io/pbrt/pbrt_loader.h"
#include "scene_io/ply/ply_loader.h"
#include "scene_io/relume_json/relume_json.h"
#include "scene_io/testing/example_files.h"

namespace relume {
namespace {

using testing::example_files;
using testing::ExampleFile;
using testing::GltfBuilder;
using testing::json;
using testing::SceneFolder;
using testing::to_bytes;

/// Folder of the examples that relume JSON references.
const SceneFolder& folder() {
  static const SceneFolder kFolder;
  static const bool kFilled = [] {
    for (const ExampleFile& file : example_files()) kFolder.write(file.name, file.bytes);
    return true;
  }();
  EXPECT_TRUE(kFilled);
  return kFolder;
}

Scene load(const std::string& name, const Bytes& bytes) {
  const std::string extension = name.substr(name.rfind('.') + 1);
  if (extension == "gltf" || extension == "glb") return load_gltf_from_memory(bytes, folder().path(), name);
  if (extension == "json") return load_relume_json_from_memory(bytes, folder().path(), name);
  if (extension == "pbrt") return load_pbrt_from_memory(bytes, folder().path(), name);
  if (extension == "xml") return load_mitsuba_from_memory(bytes, folder().path(), name);
  if (extension == "ply") return load_ply_from_memory(bytes, name);
  return load_assimp_from_memory(bytes, extension, name);
}

/// Renders 4 × 4 pixels. Fails on non-finite pixels and on replaced samples.
void expect_image(Scene scene, const std::string& what) {
  RenderSettings settings;
  settings.width = settings.height = 4;
  settings.threads = 1;
  settings.animation = "all";
  const bool moves = !scene.animation.empty();
  Session session(std::move(scene), settings);
  session.render_frame();
  if (moves) session.set_time(0.5f);
  session.render_frame();
  EXPECT_EQ(session.statistics().nonfinite_samples, 0u) << what;
}

/// Loads and renders a file. Returns whether it raised Error; any other exception fails the test.
bool is_refused(const std::string& name, const Bytes& bytes, const std::string& what) {
  constexpr double kLimitS = 20;  // well above the time for these small files, also under sanitizers
  const auto start = std::chrono::steady_clock::now();
  bool refused = false;
  try {
    expect_image(load(name, bytes), name + " " + what);
  } catch (const Error& error) {
    refused = true;
    EXPECT_GT(std::string_view(error.what()).size(), name.size()) << what;
  } catch (const std::exception& exception) {
    ADD_FAILURE() << name << " " << what << ": " << exception.what();
  }
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), kLimitS)
      << name << " " << what;
  return refused;
}

Bytes flipped(Bytes bytes, uint32_t seed) {
  std::mt19937 random(seed);
  const uint32_t flips = 1 + random() % 3;
  for (uint32_t i = 0; i < flips; ++i) bytes[random() % bytes.size()] ^= static_cast<std::byte>(1u << (random() % 8));
  return bytes;
}

TEST(Malformed, IntactExamplesLoad) {
  for (const ExampleFile& file : example_files()) {
    const Scene scene = load(file.name, file.bytes);
    EXPECT_FALSE(scene.meshes.empty()) << file.name;
  }
}

TEST(Malformed, TruncatedFiles) {
  constexpr size_t kCuts = 20;
  for (const ExampleFile& file : example_files()) {
    int refused = 0;
    for (size_t i = 1; i < kCuts; ++i) {
      Bytes cut = file.bytes;
      cut.resize(cut.size() * i / kCuts);
      refused += is_refused(file.name, cut, "cut " + std::to_string(i));
    }
    EXPECT_GE(refused, 1) << file.name;
    EXPECT_TRUE(is_refused(file.name, {}, "the empty file"));
  }
}

void flip_bits_of_files(uint32_t first, uint32_t end) {
  for (const ExampleFile& file : example_files()) {
    for (uint32_t i = first; i < end; ++i) is_refused(file.name, flipped(file.bytes, i), "flips " + std::to_string(i));
  }
}
TEST(Malformed, FilesWithFlippedBits) { flip_bits_of_files(0, 20); }
TEST(SlowMalformed, FilesWithFlippedBits) { flip_bits_of_files(20, 100); }

/// The example's document.
json document_of(const std::string& name) {
  for (const ExampleFile& file : example_files()) {
    if (file.name != name) continue;
    return json::parse(std::string_view(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size()));
  }
  return {};
}

/// Loads the example with each value at each of `places`; returns the number of inputs.
int replace_values(const std::string& name, std::span<const char* const> places) {
  const json kValues[] = {-1,  1000000, 4294967295u, 9223372036854775807ll, 18446744073709551615ull, 1e300,
                          0.5, "text",  nullptr,     json::array(),         json::object()};
  const json document = document_of(name);
  EXPECT_TRUE(document.is_object()) << name;
  int inputs = 0;
  for (const char* place : places) {
    for (const json& value : kValues) {
      json damaged = document;
      damaged[json::json_pointer(place)] = value;
      is_refused(name, to_bytes(damaged.dump()), std::string(place) + " = " + value.dump());
      ++inputs;
    }
  }
  return inputs;
}

TEST(Malformed, WrongIndicesAndSizesInGltf) {
  const char* const kPlaces[] = {"/scene",
                                 "/scenes/0/nodes/0",
                                 "/nodes/0/mesh",
                                 "/nodes/0/children/0",
                                 "/nodes/1/camera",
                                 "/meshes/0/primitives/0/indices",
                                 "/meshes/0/primitives/0/material",
                                 "/meshes/0/primitives/0/mode",
                                 "/meshes/0/primitives/0/attributes/POSITION",
                                 "/meshes/0/primitives/0/attributes/NORMAL",
                                 "/accessors/0/bufferView",
                                 "/accessors/0/count",
                                 "/accessors/0/byteOffset",
                                 "/accessors/0/componentType",
                                 "/accessors/0/type",
                                 "/accessors/0/sparse/count",
                                 "/accessors/0/sparse/indices/bufferView",
                                 "/accessors/0/sparse/values/byteOffset",
                                 "/bufferViews/0/buffer",
                                 "/bufferViews/0/byteOffset",
                                 "/bufferViews/0/byteLength",
                                 "/bufferViews/0/byteStride",
                                 "/buffers/0/byteLength",
                                 "/buffers/0/uri",
                                 "/images/0/bufferView",
                                 "/textures/0/source",
                                 "/textures/0/sampler",
                                 "/samplers/0/wrapS",
                                 "/materials/0/normalTexture/index",
                                 "/animations/0/channels/0/sampler",
                                 "/animations/0/channels/0/target/node",
                                 "/animations/0/samplers/0/input",
                                 "/animations/0/samplers/0/output",
                                 "/extensions/KHR_lights_punctual/lights/0",
                                 "/materials/0/extensions",
                                 "/cameras/0/perspective",
                                 "/asset/version"};
  EXPECT_GE(replace_values("rich.gltf", kPlaces), 300);
}

TEST(Malformed, WrongSkinsAndMorphTargetsInGltf) {
  const char* const kPlaces[] = {"/skins/0",
                                 "/skins/0/joints",
                                 "/skins/0/joints/0",
                                 "/skins/0/joints/1",
                                 "/skins/0/inverseBindMatrices",
                                 "/skins/0/skeleton",
                                 "/nodes/2/skin",
                                 "/nodes/2/weights",
                                 "/nodes/2/mesh",
                                 "/meshes/0/weights",
                                 "/meshes/0/weights/0",
                                 "/meshes/0/extras/targetNames",
                                 "/meshes/0/primitives/0/targets",
                                 "/meshes/0/primitives/0/targets/0",
                                 "/meshes/0/primitives/0/targets/0/POSITION",
                                 "/meshes/0/primitives/0/attributes/JOINTS_0",
                                 "/meshes/0/primitives/0/attributes/WEIGHTS_0",
                                 "/meshes/0/primitives/0/attributes/JOINTS_1",
                                 "/animations/1/channels/0/target",
                                 "/animations/1/channels/0/target/path",
                                 "/animations/1/samplers/0/output",
                                 "/animations/1/samplers/0/interpolation",
                                 "/animations/1/samplers/0/input",
                                 "/nodes/0/scale",
                                 "/nodes/1/matrix",
                                 "/nodes/0/extensions/KHR_node_visibility/visible",
                                 "/meshes/0/primitives/0/targets/1/NORMAL",
                                 "/meshes/0/primitives/0/targets/1/TANGENT"};
  EXPECT_GE(replace_values("figure.gltf", kPlaces), 300);
}

TEST(Malformed, NotFiniteVerticesAndZeroAreas) {
  const float values[] = {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity, 3.4e38f, 1e-45f};
  for (const float value : values) {
    for (size_t at = 0; at < 9; ++at) {
      std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
      positions[at] = value;
      GltfBuilder file;
      file.add_root(
          {{"mesh",
            file.add_triangle(
                {{"attributes", {{"POSITION", file.floats(positions, 3)}, {"NORMAL", file.floats(positions, 3)}}}})}});
      is_refused("a.gltf", to_bytes(file.text()), "value " + std::to_string(value));
    }
  }
  GltfBuilder point;
  point.add_root(
      {{"mesh", point.add_triangle({{"attributes", {{"POSITION", point.floats(std::vector<float>(9, 1.0f), 3)}}}})}});
  EXPECT_FALSE(is_refused("a.gltf", to_bytes(point.text()), "zero area"));
  for (const float far : {9e17f, 1e12f, 9e8f}) {
    GltfBuilder file;
    file.add_root(
        {{"mesh", file.add_triangle(
                      {{"attributes", {{"POSITION", file.floats({-far, -far, 0, far, -far, 0, 0, far, 0}, 3)}}}})}});
    EXPECT_FALSE(is_refused("a.gltf", to_bytes(file.text()), "far " + std::to_string(far)));
  }
  is_refused("a.obj", to_bytes("v nan inf -inf\nv 1e999 0 0\nv 0 0 0\nf 1 2 3\nf 1 1 1\nf 0 9 -9\n"), "obj");
  is_refused("a.obj", to_bytes("v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\nf 1 1 1\n"), "obj zero area");
}

TEST(Malformed, TransformsThatCollapseOrReachTooFar) {
  const json kTransforms[] = {
      {{"scale", {0, 0, 0}}},          {{"scale", {1, 0, 1}}},
      {{"scale", {1, 1, 0}}},          {{"scale", {1e-30, 1e-30, 1e-30}}},
      {{"scale", {1e30, 1e30, 1e30}}}, {{"scale", {3e38, 1, 1}}},
      {{"translation", {0, 0, 1e20}}}, {{"translation", {1e300, 0, 0}}},
      {{"rotation", {0, 0, 0, 0}}},    {{"matrix", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1}}}};
  const json kContents[] = {{{"mesh", 0}},
                            {{"camera", 0}},
                            {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
                            {{"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}}};
  for (const json& transform : kTransforms) {
    for (const json& content : kContents) {
      for (const bool above : {false, true}) {
        GltfBuilder file;
        file.add_root({{"mesh", file.add_triangle()}, {"translation", {0, 0, -1}}});
        file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
        file.doc["extensionsUsed"] = {"KHR_lights_punctual"};
        file.doc["extensions"] = {
            {"KHR_lights_punctual",
             {{"lights", {{{"type", "spot"}, {"spot", {{"outerConeAngle", 0.7}}}}, {{"type", "directional"}}}}}}};
        json node = content;
        if (above) {
          json parent = transform;
          parent["children"] = {file.add("nodes", node)};
          file.add_root(parent);
        } else {
          node.update(transform);
          file.add_root(node);
        }
        is_refused("a.gltf", to_bytes(file.text()), transform.dump() + " of " + content.dump());
      }
    }
  }
}

/// Replaces numbers of a text, and replaces, removes or repeats some of its words.
std::string reworded(const std::string& text, uint32_t seed) {
  static const char* const kNumbers[] = {"0 ", "-1 ", "2 ", "1e30 ", "1e-30 ", "-1e300 ", "4294967296 ", "0.5 "};
  static const char* const kWords[] = {"-1",      "0",     "1e30",       "1e-30",        "nan",      "99999999999999",
                                       "\"\"",    "[",     "]",          "\"float x\"",  "true",     "[ 1 2 3 ]",
                                       "Include", "Shape", "WorldBegin", "AttributeEnd", "\"half\"", "ObjectEnd"};
  std::vector<std::string> words;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find_first_of(" \n", at), text.size() - 1) + 1;
    words.push_back(text.substr(at, end - at));
    at = end;
  }
  std::mt19937 random(seed);
  for (uint32_t i = 0; i < 1 + seed % 8; ++i) {
    std::string& word = words[random() % words.size()];
    const bool is_number = word.find_first_not_of("0123456789.- \n") == std::string::npos;
    if (is_number || random() % 4 != 0) {
      if (is_number && word.size() > 1) word = kNumbers[random() % std::size(kNumbers)];
      continue;
    }
    switch (random() % 4) {
      case 0: word.clear(); break;
      case 1: word += word; break;
      case 2: word = words[random() % words.size()]; break;
      default: word = std::string(kWords[random() % std::size(kWords)]) + " "; break;
    }
  }
  std::string result;
  for (const std::string& word : words) result += word;
  return result;
}

/// Replaces words in so many ways. A fifth to four fifths are refused.
void reword_pbrt(uint32_t variants) {
  for (const ExampleFile& file : example_files()) {
    if (!file.name.ends_with(".pbrt")) continue;
    const std::string text(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size());
    uint32_t refused = 0;
    for (uint32_t i = 0; i < variants; ++i)
      refused += is_refused(file.name, to_bytes(reworded(text, i)), "words " + std::to_string(i)) ? 1 : 0;
    EXPECT_GE(refused, variants / 5);
    EXPECT_LE(refused, variants / 5 * 4);
  }
}
TEST(Malformed, PbrtWithOtherWords) { reword_pbrt(200); }
TEST(SlowMalformed, PbrtWithOtherWords) { reword_pbrt(500); }

}  // namespace
}  // namespace relume
