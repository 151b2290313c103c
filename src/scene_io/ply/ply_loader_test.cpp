#include "scene_io/ply/ply_loader.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/srgb.h"
#include "relume/scene_io.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::error_of;
using testing::mentions;
using testing::to_bytes;

Scene load(const std::string& text) { return load_ply_from_memory(to_bytes(text), "a.ply"); }

const std::string kVertices = "element vertex 4\nproperty float x\nproperty double y\nproperty int z\n";
const std::string kFaces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST(Ply, LoadsAsciiWithColoursAndTextureCoordinates) {
  const Scene scene = load(
      "ply\r\nformat ascii 1.0\r\ncomment hello\r\nelement vertex 3\r\nproperty float x\nproperty float y\nproperty "
      "float z\nproperty float s\nproperty float t\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\nelement face 1\n"
      "property list uchar int vertex_index\nend_header\n0 0 0 0 0 255 0 0 51\n1 0 0 1 0 0 255 0 255\n0 1 0 0 1 0 0 "
      "255 255\n3 0 1 2\n");
  const Mesh& mesh = scene.meshes.at(0);
  EXPECT_EQ(mesh.positions[1], Vec3(1, 0, 0));
  EXPECT_EQ(mesh.colors[0], Vec4(1, 0, 0, 0.2f));
  EXPECT_EQ(mesh.uv0[2], Vec2(0, 0));  // v points down
  EXPECT_EQ(mesh.normals[0], Vec3(0, 0, 1));
  EXPECT_EQ(mesh.triangles, std::vector<UVec3>{UVec3(0, 1, 2)});
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Ply, FindsPropertiesByNameInAnyOrder) {
  const Scene scene = load(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float z\nproperty uchar blue\nproperty float nz\nproperty "
      "float y\nproperty float ny\nproperty float texture_v\nproperty uchar red\nproperty float x\nproperty ushort "
      "green\nproperty float nx\nproperty float texture_u\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n"
      "3 51 0 2 1 0.25 255 1 65535 0 0.5\n0 0 0 0 1 0 0 1 0 0 0\n0 0 0 1 1 0 0 0 0 0 0\n3 0 1 2\n");
  const Mesh& mesh = scene.meshes.at(0);
  EXPECT_EQ(mesh.positions[0], Vec3(1, 2, 3));
  EXPECT_EQ(mesh.normals[0], Vec3(0, 1, 0));
  EXPECT_EQ(mesh.uv0[0], Vec2(0.5f, 0.75f));
  EXPECT_EQ(mesh.colors[0], Vec4(1, 1, linear_from_srgb(0.2f), 1));  // sRGB-encoded
  EXPECT_NE(error_of([&] {
              load("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float w\n" +
                   kFaces + "0 0 0\n3 0 0 0\n");
            }).find("no x, y and z"),
            std::string::npos);
}

TEST(Ply, FansPolygonsAndSkipsOtherElements) {
  const Scene scene =
      load("ply\nformat ascii 1.0\n" + kVertices + "element edge 1\nproperty int a\nproperty list uchar float b\n" +
           kFaces + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n7 2 0.5 0.5\n4 0 1 2 3\n");
  EXPECT_EQ(scene.meshes.at(0).triangles, (std::vector<UVec3>{{0, 1, 2}, {0, 2, 3}}));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("its element 'edge' is ignored"), std::string::npos);
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  EXPECT_NE(error_of([&] {
              load("ply\nformat ascii 1.0\n" + kVertices + strips + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
            }).find("triangle strips are not supported"),
            std::string::npos);
}

TEST(Ply, LoadsBothByteOrders) {
  const auto file = [](bool big) {
    Bytes bytes = to_bytes(std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
                           " 1.0\n" + kVertices + kFaces);
    const auto append = [&](auto value) {
      std::byte raw[sizeof value];
      std::memcpy(raw, &value, sizeof value);
      if (big) std::reverse(std::begin(raw), std::end(raw));
      bytes.insert(bytes.end(), std::begin(raw), std::end(raw));
    };
    for (int i = 0; i < 4; ++i) {
      append(static_cast<float>(i % 2));
      append(static_cast<double>(i / 2));
      append(int32_t{5});
    }
    append(uint8_t{3});
    for (const int32_t i : {0, 1, 2}) append(i);
    return bytes;
  };
  for (const bool big : {false, true}) {
    const Scene scene = load_ply_from_memory(file(big), "a.ply");
    EXPECT_EQ(scene.meshes.at(0).positions[3], Vec3(1, 1, 5));
    EXPECT_EQ(scene.meshes.at(0).triangles.size(), 1u);
  }
}

TEST(Ply, RefusesDamagedFiles) {
  const std::string head = "ply\nformat ascii 1.0\n";
  EXPECT_NE(error_of([&] { load("plx\n"); }).find("does not start"), std::string::npos);
  EXPECT_NE(error_of([&] { load(head); }).find("header does not end"), std::string::npos);
  EXPECT_NE(error_of([&] { load(head + kVertices + kFaces + "0 0 0\n1 0"); }).find("ends too early"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              load(head + kVertices + kFaces + "0 0 zero\n1 0 0 1 1 1 2 2 2 2 2 3 3 1 1 1");
            }).find("'zero' is not a number"),
            std::string::npos);
  EXPECT_NE(
      error_of([&] {
        load(head +
             "element vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n");
      }).find("do not fit into"),
      std::string::npos);
  EXPECT_NE(
      error_of([&] { load(head + "element vertex 1\nproperty float x\nend_header\n0 0 0\n"); }).find("no x, y and z"),
      std::string::npos);
  EXPECT_NE(error_of([&] { load(head + kVertices + "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"); }).find("no triangles"),
            std::string::npos);
}

}  // namespace
}  // namespace relume
