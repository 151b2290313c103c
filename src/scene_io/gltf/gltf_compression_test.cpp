// Tests EXT_meshopt_compression and KHR_draco_mesh_compression with data from their own encoders.
#include <draco/compression/encode.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "scene_io/testing/compressed_files.h"

namespace relume {
namespace {

using testing::compress;
using testing::draco_file;
using testing::draco_quad;
using testing::encode_vertices;
using testing::error_of;
using testing::GltfBuilder;
using testing::json;
using testing::meshopt_quad;

Scene load_fallback(const GltfBuilder& file) { return testing::load_text(testing::text_with_fallback(file)); }

TEST(GltfMeshopt, DecodesVerticesAndTrianglesWithFallbackBuffer) {
  const Scene scene = load_fallback(meshopt_quad());
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions[3], Vec3(1, 1, 0));
  // The codec may rotate a triangle's corners.
  ASSERT_EQ(scene.meshes[0].triangles.size(), 2u);
  const UVec3 t = scene.meshes[0].triangles[1];
  EXPECT_EQ(t.x + t.y + t.z, 6u);
}

TEST(GltfMeshopt, DecodesIndexSequences) {
  GltfBuilder file;
  const std::vector<uint32_t> corners = {0, 1, 2, 2, 1, 3};
  Bytes bytes(meshopt_encodeIndexSequenceBound(6, 6));
  bytes.resize(
      meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), corners.data(), 6));
  const int indices = compress(file, bytes, 6, 4, "INDICES");
  const int positions = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 3);
  file.add("meshes",
           {{"primitives",
             {{{"attributes", {{"POSITION", positions}}}, {"indices", file.add_accessor(indices, 6, 1, 5125)}}}}});
  file.add_root({{"mesh", 0}});
  EXPECT_EQ(load_fallback(file).meshes[0].triangles, (std::vector<UVec3>{{0, 1, 2}, {2, 1, 3}}));
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
#if MESHOPTIMIZER_VERSION >= 190
  meshopt_encodeFilterExp(exp, 2, 16, 15, offsets, meshopt_EncodeExpSharedVector);
#else
  meshopt_encodeFilterExp(exp, 2, 16, 15, offsets);
#endif
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
  const Scene scene = load_fallback(file);
  // Accuracy: 8-bit octahedral normals about 1/127; 12-bit rotations 1/2000; 15-bit offsets 2^-13 here.
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
    return error_of([&] { load_fallback(file); });
  };
  EXPECT_NE(load_changed("count", 100000000).find("cannot come from"), std::string::npos);
  EXPECT_NE(load_changed("byteStride", 3).find("byte stride 3"), std::string::npos);
  EXPECT_NE(load_changed("mode", "FOO").find("unknown compression mode"), std::string::npos);
  EXPECT_NE(load_changed("buffer", 9).find("missing buffer"), std::string::npos);
  EXPECT_NE(load_changed("byteLength", 5).find("damaged"), std::string::npos);
  EXPECT_NE(load_changed("byteOffset", -1).find("out of range"), std::string::npos);
  EXPECT_NE(load_changed("filter", "QUATERNION").find("filter"), std::string::npos);
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
