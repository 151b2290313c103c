// EXT_meshopt_compression and KHR_draco_mesh_compression, against data that their own encoders made.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "io/testing/scene_files.h"

namespace relume {
namespace {

using testing::error_of;
using testing::GltfBuilder;
using testing::json;

const std::vector<float> kPositions = {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0};  // 4 vertices, stride 16
const std::vector<uint32_t> kIndices = {0, 1, 2, 2, 1, 3};

Bytes encode_vertices(const void* data, size_t count, size_t stride) {
  Bytes bytes(meshopt_encodeVertexBufferBound(count, stride));
  bytes.resize(
      meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), data, count, stride));
  return bytes;
}

Bytes encode_triangles(const std::vector<uint32_t>& indices) {
  Bytes bytes(meshopt_encodeIndexBufferBound(indices.size(), indices.size()));
  bytes.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), indices.data(),
                                         indices.size()));
  return bytes;
}

/// Makes view `view` compressed: it belongs to the fallback buffer 1, its data to buffer 0.
int compress(GltfBuilder& file, const Bytes& data, size_t count, size_t stride, const char* mode,
             const char* filter = "NONE") {
  const int view = file.add_view(data);
  json& v = file.doc["bufferViews"][static_cast<size_t>(view)];
  const json extension = {{"buffer", 0},
                          {"byteOffset", v["byteOffset"]},
                          {"byteLength", v["byteLength"]},
                          {"count", count},
                          {"mode", mode},
                          {"byteStride", stride},
                          {"filter", filter}};
  v = {{"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", extension}}}};
  if (std::string_view(mode) == "ATTRIBUTES") v["byteStride"] = stride;
  return view;
}

/// The builder's file with a second buffer that has no bytes.
Scene load_with_fallback(const GltfBuilder& file) {
  json doc = json::parse(file.text());
  doc["extensionsRequired"] = {"EXT_meshopt_compression"};
  doc["buffers"].push_back(
      {{"byteLength", 100000}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  return testing::load_text(doc.dump());
}

GltfBuilder meshopt_quad() {
  GltfBuilder file;
  const int positions = compress(file, encode_vertices(kPositions.data(), 4, 16), 4, 16, "ATTRIBUTES");
  const int indices = compress(file, encode_triangles(kIndices), 6, 4, "TRIANGLES");
  const json primitive = {{"attributes", {{"POSITION", file.add_accessor(positions, 4, 3, 5126)}}},
                          {"indices", file.add_accessor(indices, 6, 1, 5125)}};
  file.add("meshes", {{"primitives", {primitive}}});
  file.add_root({{"mesh", 0}});
  return file;
}

TEST(GltfMeshopt, DecodesVerticesAndTrianglesWithFallbackBuffer) {
  const Scene scene = load_with_fallback(meshopt_quad());
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions[3], Vec3(1, 1, 0));
  // The codec may rotate the corners of a triangle.
  ASSERT_EQ(scene.meshes[0].triangles.size(), 2u);
  const UVec3 t = scene.meshes[0].triangles[1];
  EXPECT_EQ(t.x + t.y + t.z, 6u);
}

TEST(GltfMeshopt, DecodesIndexSequences) {
  GltfBuilder file;
  Bytes bytes(meshopt_encodeIndexSequenceBound(6, 6));
  bytes.resize(
      meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), kIndices.data(), 6));
  const int indices = compress(file, bytes, 6, 4, "INDICES");
  const int positions = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 3);
  file.add("meshes",
           {{"primitives",
             {{{"attributes", {{"POSITION", positions}}}, {"indices", file.add_accessor(indices, 6, 1, 5125)}}}}});
  file.add_root({{"mesh", 0}});
  EXPECT_EQ(load_with_fallback(file).meshes[0].triangles, (std::vector<UVec3>{{0, 1, 2}, {2, 1, 3}}));
}

TEST(GltfMeshopt, AppliesFilters) {
  const float normals[12] = {0, 0, 1, 0, 0.6f, 0, 0.8f, 0, 0, 1, 0, 0};
  const float rotations[8] = {0, 0, 0, 1, 0, 0.70710678f, 0, 0.70710678f};
  const float offsets[8] = {1, 2, 3, 0, -4, 5, 0.5f, 0};
  int8_t oct[12];
  int16_t quat[8];
  uint32_t exp[8];
  meshopt_encodeFilterOct(oct, 3, 4, 8, normals);
  meshopt_encodeFilterQuat(quat, 2, 8, 12, rotations);
  meshopt_encodeFilterExp(exp, 2, 16, 15, offsets);
  GltfBuilder file;
  const int normal_view = compress(file, encode_vertices(oct, 3, 4), 3, 4, "ATTRIBUTES", "OCTAHEDRAL");
  const int rotation_view = compress(file, encode_vertices(quat, 2, 8), 2, 8, "ATTRIBUTES", "QUATERNION");
  const int offset_view = compress(file, encode_vertices(exp, 2, 16), 2, 16, "ATTRIBUTES", "EXPONENTIAL");
  const int rotation = file.add_accessor(rotation_view, 2, 4, 5122, true);
  const int offset = file.add_accessor(offset_view, 2, 3, 5126);
  const int normal = file.add_accessor(normal_view, 3, 3, 5120, true);
  const int positions = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  file.add("meshes", {{"primitives", {{{"attributes", {{"POSITION", positions}, {"NORMAL", normal}}}}}}});
  file.add_root({{"mesh", 0},
                 {"extensions",
                  {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", offset}, {"ROTATION", rotation}}}}}}}});
  const Scene scene = load_with_fallback(file);
  // 8-bit octahedral normals are exact to about 1/127; 12-bit rotations to 1/2000; 15-bit offsets to 2^-13 here.
  EXPECT_NEAR(glm::distance(scene.meshes[0].normals[1], Vec3(0.6f, 0, 0.8f)), 0, 0.02);
  ASSERT_EQ(scene.nodes[0].instances.size(), 2u);
  EXPECT_NEAR(glm::distance(Vec3(scene.nodes[0].instances[1][3]), Vec3(-4, 5, 0.5f)), 0, 1e-3);
  EXPECT_NEAR(glm::distance(Vec3(scene.nodes[0].instances[1][0]), Vec3(0, 0, -1)), 0, 2e-3);  // 90° about +Y: X to -Z
}

TEST(GltfMeshopt, RefusesDamagedAndAbsurdData) {
  const GltfBuilder good = meshopt_quad();
  const auto load_changed = [&](const char* key, const json& value) {
    GltfBuilder file = good;
    file.doc["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
    return error_of([&] { load_with_fallback(file); });
  };
  EXPECT_NE(load_changed("count", 100000000).find("cannot come from"), std::string::npos);
  EXPECT_NE(load_changed("byteStride", 3).find("byte stride 3"), std::string::npos);
  EXPECT_NE(load_changed("mode", "FOO").find("unknown compression mode"), std::string::npos);
  EXPECT_NE(load_changed("buffer", 9).find("missing buffer"), std::string::npos);
  EXPECT_NE(load_changed("byteLength", 5).find("damaged"), std::string::npos);
  EXPECT_NE(load_changed("byteOffset", -1).find("out of range"), std::string::npos);
  EXPECT_NE(load_changed("filter", "QUATERNION").find("filter"), std::string::npos);
}

/// Two triangles with positions (id 0), texture coordinates (id 1).
Bytes draco_quad(int method) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_UINT16);
  const float p[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const uint16_t t[4][2] = {{0, 0}, {65535, 0}, {0, 65535}, {65535, 65535}};
  const int corners[2][3] = {{0, 1, 2}, {2, 1, 3}};
  for (int f = 0; f < 2; ++f) {
    const int* c = corners[f];
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(static_cast<uint32_t>(f)), p[c[0]], p[c[1]], p[c[2]]);
    builder.SetAttributeValuesForFace(uv, draco::FaceIndex(static_cast<uint32_t>(f)), t[c[0]], t[c[1]], t[c[2]]);
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return testing::to_bytes({buffer.data(), buffer.size()});
}

GltfBuilder draco_file(const Bytes& data) {
  GltfBuilder file;
  const int view = file.add_view(data);
  const int positions = file.add("accessors", {{"count", 4}, {"type", "VEC3"}, {"componentType", 5126}});
  const int uv = file.add("accessors", {{"count", 4}, {"type", "VEC2"}, {"componentType", 5123}, {"normalized", true}});
  const int indices = file.add("accessors", {{"count", 6}, {"type", "SCALAR"}, {"componentType", 5123}});
  const json extension = {{"bufferView", view}, {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}};
  file.add("meshes", {{"primitives",
                       {{{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv}}},
                         {"indices", indices},
                         {"extensions", {{"KHR_draco_mesh_compression", extension}}}}}}});
  file.add_root({{"mesh", 0}});
  return file;
}

TEST(GltfDraco, DecodesBothMethods) {
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const Scene scene = draco_file(draco_quad(method)).load();
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.triangles.size(), 2u);
    for (size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(glm::distance(Vec2(mesh.positions[i]), mesh.uv0[i]), 0, 1e-3);  // 14 bits
  }
}

TEST(GltfDraco, RefusesDamagedData) {
  Bytes data = draco_quad(draco::MESH_EDGEBREAKER_ENCODING);
  data.resize(data.size() / 2);
  EXPECT_NE(error_of([&] { draco_file(data).load(); }).find("Draco data are damaged"), std::string::npos);
  GltfBuilder file = draco_file(draco_quad(draco::MESH_EDGEBREAKER_ENCODING));
  file.doc["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["NORMAL"] = 17;
  EXPECT_NE(error_of([&] { file.load(); }).find("lack attribute NORMAL"), std::string::npos);
}

}  // namespace
}  // namespace relume
