// Files, nodes and primitives of glTF.
#include <cmath>

#include <gtest/gtest.h>

#include "relume/scene_io.h"
#include "scene/scene_hash.h"
#include "scene_io/gltf/gltf_loader.h"
#include "scene_io/testing/example_files.h"

namespace relume {
namespace {

using testing::error_of;
using testing::GltfBuilder;
using testing::json;
using testing::mentions;
using testing::SceneFolder;

GltfBuilder triangle_file() {
  GltfBuilder file;
  file.add_root({{"mesh", file.add_triangle()}});
  return file;
}

TEST(Gltf, LoadsATriangleFromDataUri) {
  const Scene scene = triangle_file().load();
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions[1], Vec3(1, 0, 0));
  EXPECT_EQ(scene.meshes[0].triangles, std::vector<UVec3>{UVec3(0, 1, 2)});
  EXPECT_TRUE(scene.meshes[0].normals.empty());
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Gltf, LoadsGlbFileByContent) {
  const SceneFolder folder;
  const auto file = folder.write("scene.bin", triangle_file().glb());
  EXPECT_EQ(load_scene(file).meshes.size(), 1u);
}

TEST(Gltf, LoadsBufferFileWithEscapedName) {
  const SceneFolder folder;
  const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  folder.write("my buffer.bin", std::string_view(reinterpret_cast<const char*>(positions), sizeof positions));
  json doc = triangle_file().doc;
  doc["buffers"] = json::array({{{"uri", "my%20buffer.bin"}, {"byteLength", 36}}});
  EXPECT_EQ(load_gltf(folder.write("a.gltf", doc.dump())).meshes.size(), 1u);

  doc["buffers"][0]["uri"] = "missing.bin";
  const auto broken = folder.write("b.gltf", doc.dump());
  EXPECT_NE(error_of([&] { load_gltf(broken); }).find("missing.bin' does not exist"), std::string::npos);
  doc["buffers"][0]["uri"] = std::string(300, 'n');
  const auto long_name = folder.write("d.gltf", doc.dump());
  EXPECT_NE(error_of([&] { load_gltf(long_name); }).find("cannot be reached (File name too long)"), std::string::npos);
  doc["buffers"][0]["uri"] = "my buffer.bin";
  doc["buffers"][0]["byteLength"] = 40;
  const auto truncated = folder.write("c.gltf", doc.dump());
  EXPECT_NE(error_of([&] { load_gltf(truncated); }).find("damaged"), std::string::npos);
}

/// Writes all integers as reals: 3.0.
json with_reals(const json& value) {
  if (value.is_number_integer()) return value.get<double>();
  json result = value;
  for (json& element : result) {
    if (value.is_structured()) element = with_reals(element);
  }
  return result;
}

TEST(Gltf, ReadsIntegersThatAreWrittenAsReals) {
  for (const testing::ExampleFile& file : testing::example_files()) {
    if (!file.name.ends_with(".gltf")) continue;
    const json doc = json::parse(reinterpret_cast<const char*>(file.bytes.data()),
                                 reinterpret_cast<const char*>(file.bytes.data()) + file.bytes.size());
    const std::string text = with_reals(doc).dump();
    ASSERT_NE(text.find("5126.0"), std::string::npos);
    const Scene scene = testing::load_text(text);
    const Scene expected = testing::load_text(doc.dump());
    EXPECT_EQ(scene_hash(scene), scene_hash(expected)) << file.name;
    EXPECT_EQ(scene.warnings, expected.warnings) << file.name;
  }
  json doc = triangle_file().doc;
  doc["accessors"][0]["count"] = 2.5;
  EXPECT_NE(error_of([&] { testing::load_text(doc.dump()); }), "");
}

TEST(Gltf, KeepsLargeNumbersOfExtensionsAndNegativeZeros) {
  GltfBuilder file;
  const int material = file.add_triangle_with_material(
      {{"emissiveFactor", {1.0, 0.0, 0.0}},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e10}}}}}});
  file.doc["nodes"][0]["translation"] = {-0.0, 3.0, -2.0};
  file.doc["extensionsUsed"] = {"KHR_materials_emissive_strength"};
  const Scene scene = file.load();
  EXPECT_EQ(scene.materials.at(static_cast<size_t>(material)).emission.x, 1e10f);
  EXPECT_TRUE(std::signbit(scene.nodes.at(0).transform.translation.x));
  EXPECT_EQ(scene.nodes[0].transform.translation, Vec3(0, 3, -2));
}

TEST(Gltf, BuffersWithoutBytesMayBeUnused) {
  json doc = json::parse(triangle_file().text());
  doc["buffers"].push_back({{"byteLength", 100}});
  doc["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 100}});
  EXPECT_EQ(testing::load_text(doc.dump()).meshes.size(), 1u);

  const std::string problem = "buffers[1] has neither a URI nor a binary chunk, but bufferViews[1] needs it; ";
  const auto error = [](const json& document) { return error_of([&] { testing::load_text(document.dump()); }); };
  json attribute = doc;
  attribute["accessors"][0]["bufferView"] = 1;
  EXPECT_EQ(error(attribute), "test.gltf: " + problem + "the file is damaged, export or copy it again");
  json sparse = doc;
  sparse["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", 1}, {"componentType", 5125}}}, {"values", {{"bufferView", 1}}}};
  EXPECT_NE(error(sparse).find(problem), std::string::npos);
  json draco = doc;
  draco["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 1},
                                                                                     {"attributes", {{"POSITION", 0}}}};
  EXPECT_NE(error(draco).find(problem), std::string::npos);
  json image = doc;
  image["images"][0] = {{"bufferView", 1}, {"mimeType", "image/png"}};
  image["textures"][0]["source"] = 0;
  image["materials"][0]["normalTexture"]["index"] = 0;
  image["meshes"][0]["primitives"][0]["material"] = 0;
  EXPECT_TRUE(mentions(testing::load_text(image.dump()).warnings, "image 0: " + problem + "export or copy the file"));
}

TEST(Gltf, WarnsAboutLaterVersions) {
  GltfBuilder file = triangle_file();
  for (const char* version : {"2.0", "1.0", "2"}) {
    file.doc["asset"]["minVersion"] = version;
    EXPECT_TRUE(file.load().warnings.empty()) << version;
  }
  for (const char* version : {"2.1", "3.0", "10"}) {
    file.doc["asset"]["minVersion"] = version;
    EXPECT_TRUE(mentions(file.load().warnings, std::string("the file requires glTF ") + version)) << version;
  }
}

TEST(Gltf, KeepsTransformsMatricesAndParents) {
  GltfBuilder file;
  file.add("nodes", {{"name", "child"}, {"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1}}});
  file.add_root({{"name", "root"},
                 {"translation", {1, 2, 3}},
                 {"rotation", {0, 0, 2, 0}},
                 {"scale", {1, 2, 3}},
                 {"children", {0}}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.nodes.size(), 2u);
  EXPECT_EQ(scene.nodes[0].name, "root");
  EXPECT_EQ(scene.nodes[0].transform.translation, Vec3(1, 2, 3));
  EXPECT_EQ(scene.nodes[0].transform.rotation, glm::quat(0, 0, 0, 1));  // normalised
  EXPECT_EQ(scene.nodes[0].transform.scale, Vec3(1, 2, 3));
  EXPECT_EQ(scene.nodes[1].parent, 0);
  ASSERT_TRUE(scene.nodes[1].matrix.has_value());
  EXPECT_EQ((*scene.nodes[1].matrix)[3], Vec4(5, 6, 7, 1));
  // The root turns by 180° about Z, then scales: child's origin (5, 6, 7) lands at (1 - 5, 2 - 12, 3 + 21).
  const Vec3 origin(world_matrices(scene, 0)[1][3]);
  EXPECT_NEAR(glm::distance(origin, Vec3(-4, -10, 24)), 0, 1e-5);  // rounding of a few products
}

TEST(Gltf, LoadsOnlyTheDefaultScene) {
  GltfBuilder file;
  file.add("nodes", {{"name", "outside"}, {"mesh", file.add_triangle()}});
  file.add("nodes", {{"name", "inside"}});
  file.doc["scenes"] = json::array({{{"nodes", {0}}}, {{"nodes", {1}}}});
  file.doc["scene"] = 1;
  const Scene scene = file.load();
  ASSERT_EQ(scene.nodes.size(), 1u);
  EXPECT_EQ(scene.nodes[0].name, "inside");
  EXPECT_TRUE(scene.meshes.empty());
  file.doc["scene"] = 7;
  EXPECT_EQ(file.load().nodes[0].name, "outside");
  file.doc.erase("scenes");
  EXPECT_EQ(file.load().nodes.size(), 2u);
}

TEST(Gltf, SharesMeshesBetweenNodes) {
  GltfBuilder file;
  const int mesh = file.add_triangle();
  file.add_root({{"mesh", mesh}});
  file.add_root({{"mesh", mesh}});
  const Scene scene = file.load();
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.nodes[0].meshes, scene.nodes[1].meshes);
}

TEST(Gltf, RefusesCyclesAndSecondParents) {
  GltfBuilder cycle;
  cycle.add("nodes", {{"children", {1}}});
  cycle.add("nodes", {{"children", {0}}});
  EXPECT_NE(error_of([&] { cycle.load(); }).find("cycle"), std::string::npos);
  GltfBuilder self;
  self.add_root({{"children", {0}}});
  EXPECT_NE(error_of([&] { self.load(); }).find("cycle"), std::string::npos);
  GltfBuilder two;
  two.add("nodes", json::object());
  two.add_root({{"children", {0}}});
  two.add_root({{"children", {0}}});
  EXPECT_NE(error_of([&] { two.load(); }).find("two parents"), std::string::npos);
  GltfBuilder missing;
  missing.add_root({{"children", {9}}});
  EXPECT_NE(error_of([&] { missing.load(); }).find("does not exist"), std::string::npos);
}

TEST(Gltf, LoadsDeepHierarchies) {
  constexpr int kDepth = 100000;  // recursion over this would exhaust the stack of 8 MiB
  GltfBuilder file;
  json& nodes = file.doc["nodes"];
  for (int i = 0; i + 1 < kDepth; ++i) nodes.push_back({{"children", {i + 1}}});
  nodes.push_back(json::object());
  file.doc["scenes"][0]["nodes"] = {0};
  EXPECT_EQ(file.load().nodes.size(), static_cast<size_t>(kDepth));
}

TEST(Gltf, TurnsStripsAndFansIntoTriangles) {
  GltfBuilder file;
  const int positions = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, 3);
  const auto primitive = [&](int mode) { return json{{"attributes", {{"POSITION", positions}}}, {"mode", mode}}; };
  file.add("meshes", {{"primitives", {primitive(5), primitive(6), primitive(0), primitive(1)}}});
  file.add_root({{"mesh", 0}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].triangles, (std::vector<UVec3>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  EXPECT_EQ(scene.meshes[1].triangles, (std::vector<UVec3>{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
  EXPECT_TRUE(mentions(scene.warnings, "points and lines"));
}

TEST(Gltf, RemovesUnusedVerticesOfSharedBuffers) {
  GltfBuilder file;
  std::vector<float> coordinates(300);
  for (size_t i = 0; i < coordinates.size(); ++i) coordinates[i] = static_cast<float>(i);
  const int positions = file.floats(coordinates, 3);
  const int indices = file.accessor(std::vector<uint16_t>{97, 98, 99}, 1, 5123);
  file.add("meshes", {{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}});
  file.add_root({{"mesh", 0}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.meshes[0].positions.size(), 3u);
  EXPECT_EQ(scene.meshes[0].positions[0], Vec3(291, 292, 293));
  EXPECT_EQ(scene.meshes[0].triangles, std::vector<UVec3>{UVec3(0, 1, 2)});
}

TEST(Gltf, RepairsBrokenGeometry) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  GltfBuilder file;
  const int positions = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, nan}, 3);
  const int normals = file.floats({0, 0, 2, 0, 0, 0, nan, 0, 0, 0, 0, 1}, 3);
  const int indices = file.accessor(std::vector<uint8_t>{0, 1, 2, 1, 3, 2, 0, 1, 200, 1, 1, 2}, 1, 5121);
  file.add("meshes",
           {{"primitives", {{{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}}}}});
  file.add_root({{"mesh", 0}});
  const Scene scene = file.load();
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.triangles, (std::vector<UVec3>{{0, 1, 2}, {1, 1, 2}}));  // degenerate ones stay
  EXPECT_EQ(mesh.positions[3], Vec3(0));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(mesh.normals[static_cast<size_t>(i)], Vec3(0, 0, 1));
  EXPECT_TRUE(mentions(scene.warnings, "not finite"));
  EXPECT_TRUE(mentions(scene.warnings, "out of range"));
  EXPECT_TRUE(mentions(scene.warnings, "normals"));
}

TEST(Gltf, ReadsAllVertexAttributes) {
  GltfBuilder file;
  const json attributes = {
      {"POSITION", file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)},
      {"NORMAL", file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3)},
      {"TANGENT", file.floats({1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1}, 4)},
      {"TEXCOORD_0", file.floats({0, 0, 1, 0, 0, 1}, 2)},
      {"TEXCOORD_1", file.accessor(std::vector<uint16_t>{0, 0, 65535, 0, 0, 13107}, 2, 5123, true)},
      {"COLOR_0", file.accessor(std::vector<uint8_t>{255, 0, 51, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 3, 5121, true)}};
  file.doc["accessors"].back()["count"] = 3;
  file.add("meshes", {{"primitives", {{{"attributes", attributes}}}}});
  file.add_root({{"mesh", 0}});
  const Scene scene = file.load();
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.normals[0], Vec3(0, 0, 1));
  EXPECT_EQ(mesh.tangents[0], Vec4(1, 0, 0, -1));
  EXPECT_EQ(mesh.uv0[2], Vec2(0, 1));
  EXPECT_FLOAT_EQ(mesh.uv1[2].y, 0.2f);
  EXPECT_EQ(mesh.colors[0], Vec4(1, 0, 0.2f, 1));
}

TEST(Gltf, IgnoresAttributesOfAnotherLength) {
  GltfBuilder file;
  const int normals = file.floats({0, 0, 1}, 3);
  file.add_root({{"mesh", file.add_triangle({{"attributes", {{"NORMAL", normals}}}})}});
  const Scene scene = file.load();
  EXPECT_TRUE(scene.meshes[0].normals.empty());
  EXPECT_TRUE(mentions(scene.warnings, "does not fit"));
}

TEST(Gltf, NamesUnsupportedExtensions) {
  GltfBuilder file = triangle_file();
  file.doc["extensionsUsed"] = {"KHR_audio", "KHR_materials_ior"};
  const Scene scene = file.load();
  EXPECT_TRUE(mentions(scene.warnings, "KHR_audio"));
  EXPECT_FALSE(mentions(scene.warnings, "KHR_materials_ior"));
  file.doc["extensionsRequired"] = {"KHR_audio"};
  EXPECT_NE(error_of([&] { file.load(); }).find("requires the extension KHR_audio"), std::string::npos);
}

TEST(Gltf, ReadsFilesThatRequireDecorativeExtensions) {
  GltfBuilder file = triangle_file();
  file.doc["extensionsUsed"] = file.doc["extensionsRequired"] = {"KHR_xmp", "KHR_xmp_json_ld"};
  const Scene scene = file.load();
  EXPECT_TRUE(mentions(scene.warnings, "KHR_xmp"));
  EXPECT_TRUE(mentions(scene.warnings, "KHR_xmp_json_ld"));
}

TEST(Gltf, ReadsFilesThatRequireDispersion) {
  GltfBuilder file = triangle_file();
  file.doc["extensionsUsed"] = file.doc["extensionsRequired"] = {"KHR_materials_dispersion"};
  EXPECT_TRUE(file.load().warnings.empty());
}

TEST(Gltf, OcclusionTexturesGiveANoteNotAWarning) {
  GltfBuilder file;
  file.add("images", {{"uri", testing::data_uri(testing::solid_png(1, 1, 255, 255, 255, 255))}});
  file.add("textures", {{"source", 0}});
  file.add_triangle_with_material({{"occlusionTexture", {{"index", 0}}}});
  const Scene scene = file.load();
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_TRUE(mentions(scene.notes, "test.gltf: occlusion textures are ignored"));
}

TEST(Gltf, ReportsThePositionOfJsonErrors) {
  EXPECT_EQ(error_of([] { testing::load_text("{\n \"asset\": }"); }).substr(0, 14), "test.gltf:2:11");
  EXPECT_NE(error_of([] { testing::load_text("{}"); }).find("asset.version"), std::string::npos);
  EXPECT_NE(error_of([] { testing::load_text(R"({"asset":{"version":"1.0"}})"); }).find("glTF version 1.0"),
            std::string::npos);
  EXPECT_NE(error_of([] { testing::load_text(std::string(100000, '[')); }).find("nested"), std::string::npos);
}

}  // namespace
}  // namespace relume
