// Shapes of Mitsuba scenes: geometry, texture coordinates, files and instances.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/vec.h"
#include "scene_io/mitsuba/mitsuba_meshes.h"
#include "scene_io/testing/mitsuba_scene.h"
#include "scene_io/testing/serialized_file.h"

namespace relume {
namespace {

using testing::error_of;
using testing::load_mitsuba_text;
using testing::mentions;
using testing::SceneFolder;

/// Normal of a triangle's front.
Vec3 front_of(const Mesh& mesh, const UVec3& t) {
  return glm::normalize(
      glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
}

void expect_fronts_along_normals(const Mesh& mesh) {
  for (const UVec3& t : mesh.triangles) EXPECT_GT(glm::dot(front_of(mesh, t), mesh.normals[t.x]), 0.9f) << mesh.name;
}

Mesh mesh_of(const std::string& type, const std::string& parameters = "") {
  return load_mitsuba_text("<shape type=\"" + type + "\">" + parameters + "</shape>").meshes.at(0);
}

TEST(MitsubaShapes, TextureCoordinatesAreMitsubas) {
  for (const char* type : {"rectangle", "sphere", "disk", "cylinder", "cube"}) {
    const Mesh mesh = mesh_of(type);
    expect_fronts_along_normals(mesh);
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      const Vec3& p = mesh.positions[i];
      const double turn = std::atan2(p.y, p.x) / (2 * kPi);
      const Vec2 uv = mesh.uv0[i];
      const auto same_angle = [&](float u) { return std::fabs(std::remainder(u - turn, 1.0)) < 1e-5; };
      const std::string name = type;
      if (name == "rectangle") {
        EXPECT_EQ(uv, Vec2(p.x + 1, p.y + 1) / 2.0f);
      } else if (name == "sphere") {
        EXPECT_NEAR(uv.y, std::acos(p.z) / kPi, 1e-3);
        EXPECT_TRUE(std::fabs(p.z) > 0.99f || same_angle(uv.x)) << uv.x;
      } else if (name == "disk") {
        EXPECT_NEAR(uv.x, glm::length(p), 1e-5);
        EXPECT_TRUE(glm::length(p) < 0.5f || same_angle(uv.y)) << uv.y;
      } else if (name == "cylinder") {
        EXPECT_TRUE(same_angle(uv.x) && uv.y == p.z) << uv.x;
      }
    }
  }
}

TEST(MitsubaShapes, CubeFacesHaveMitsubasCorners) {
  // Corner and texture coordinates of two vertices of each face in Mitsuba's table.
  const struct {
    Vec3 normal, position;
    Vec2 uv;
  } kCorners[] = {
      {{0, -1, 0}, {1, -1, -1}, {0, 1}}, {{0, -1, 0}, {-1, -1, 1}, {1, 0}}, {{0, 1, 0}, {1, 1, -1}, {0, 1}},
      {{0, 1, 0}, {-1, 1, 1}, {1, 0}},   {{1, 0, 0}, {1, -1, -1}, {0, 1}},  {{1, 0, 0}, {1, 1, 1}, {1, 0}},
      {{0, 0, 1}, {1, -1, 1}, {0, 1}},   {{0, 0, 1}, {-1, 1, 1}, {1, 0}},   {{-1, 0, 0}, {-1, -1, 1}, {0, 1}},
      {{-1, 0, 0}, {-1, 1, -1}, {1, 0}}, {{0, 0, -1}, {1, 1, -1}, {0, 1}},  {{0, 0, -1}, {-1, -1, -1}, {1, 0}}};
  const Mesh mesh = mesh_of("cube");
  for (const auto& corner : kCorners) {
    bool found = false;
    for (size_t i = 0; i < mesh.positions.size(); ++i)
      found = found ||
              (mesh.positions[i] == corner.position && mesh.normals[i] == corner.normal && mesh.uv0[i] == corner.uv);
    EXPECT_TRUE(found) << corner.normal.x << corner.normal.y << corner.normal.z;
  }
}

TEST(MitsubaShapes, ParametersPlaceSpheresAndCylinders) {
  const Scene scene = load_mitsuba_text(
      "<shape type=\"sphere\"><point name=\"center\" x=\"1\" y=\"2\" z=\"3\"/><float name=\"radius\" "
      "value=\"2\"/><transform "
      "name=\"to_world\"><scale value=\"10\"/></transform></shape>"
      "<shape type=\"cylinder\"><point name=\"p0\" value=\"1, 1, 1\"/><point name=\"p1\" value=\"1, 5, 1\"/><float "
      "name=\"radius\" value=\"0.5\"/></shape>");
  const auto world = [&](size_t node, const Vec3& p) { return Vec3(*scene.nodes[node].matrix * Vec4(p, 1)); };
  EXPECT_LT(glm::length(world(0, {0, 0, 1}) - Vec3(10, 20, 50)), 1e-4f);
  EXPECT_LT(glm::length(world(1, {0, 0, 1}) - Vec3(1, 5, 1)), 1e-5f);
  EXPECT_NEAR(glm::length(world(1, {1, 0, 0}) - Vec3(1, 1, 1)), 0.5f, 1e-5f);
  EXPECT_NE(error_of([] { mesh_of("cylinder", "<point name=\"p1\" value=\"0, 0, 0\"/>"); }).find("p0 and p1 are equal"),
            std::string::npos);
}

TEST(MitsubaShapes, NormalsCanBeFlippedOrFlat) {
  const Mesh flipped = mesh_of("sphere", "<boolean name=\"flip_normals\" value=\"true\"/>");
  expect_fronts_along_normals(flipped);
  EXPECT_LT(glm::dot(flipped.normals[100], flipped.positions[100]), -0.99f);
  EXPECT_TRUE(mesh_of("sphere", "<boolean name=\"face_normals\" value=\"true\"/>").normals.empty());
}

constexpr const char* kObj =
    "# two faces\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0.25\nvt 1 1\nvt 0 1\n"
    "f 1/1 2/2 3/3 4/4\nf -5/1 -2/2 -1/3\n";

TEST(MitsubaShapes, ObjFiles) {
  const SceneFolder folder;
  folder.write("a.obj", kObj);
  const auto load = [&](const std::string& more) {
    return load_mitsuba_text("<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/>" + more + "</shape>",
                             folder.path())
        .meshes.at(0);
  };
  const Mesh mesh = load("");
  EXPECT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.uv0[1], Vec2(1, 0.75f));  // flip_tex_coords is true by default
  EXPECT_EQ(load("<boolean name=\"flip_tex_coords\" value=\"false\"/>").uv0[1], Vec2(1, 0.25f));
  // Both faces meet at vertices 1 and 4, where normals are smooth: areas 1 and 1/2 along +Z and +X.
  EXPECT_GT(mesh.normals[0].x, 0.1f);
  EXPECT_EQ(mesh.normals[1], Vec3(0, 0, 1));
  EXPECT_TRUE(load("<boolean name=\"face_normals\" value=\"true\"/>").normals.empty());
  EXPECT_EQ(error_of([] { mitsuba::read_obj(testing::to_bytes("v 0 0 0\nf 1 2 3\n"), true, "a.obj"); }),
            "a.obj:2: the index '2' is not in the file; export the file again");
  EXPECT_NE(
      error_of([] { mitsuba::read_obj(testing::to_bytes("v 0 0\n"), true, "a.obj"); }).find("needs 3 finite numbers"),
      std::string::npos);
}

TEST(MitsubaShapes, SeamsOfTextureCoordinatesStaySmooth) {
  Mesh mesh = mitsuba::read_obj(
      testing::to_bytes("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 3/2 4/2\n"), true,
      "a.obj");
  mitsuba::add_smooth_normals(mesh);
  ASSERT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.normals[0], mesh.normals[3]);
  EXPECT_NEAR(mesh.normals[0].x, std::sqrt(0.5f), 1e-6f);
}

TEST(MitsubaShapes, PlyFilesKeepTheirV) {
  const SceneFolder folder;
  folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty "
      "float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 "
      "0.25\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n");
  const auto load = [&](const std::string& more) {
    return load_mitsuba_text("<shape type=\"ply\"><string name=\"filename\" value=\"a.ply\"/>" + more + "</shape>",
                             folder.path())
        .meshes.at(0);
  };
  EXPECT_EQ(load("").uv0[0], Vec2(0, 0.25f));
  EXPECT_EQ(load("<boolean name=\"flip_tex_coords\" value=\"true\"/>").uv0[0], Vec2(0, 0.75f));
}

TEST(MitsubaShapes, SerializedFiles) {
  for (const uint16_t version : {uint16_t{3}, uint16_t{4}, uint16_t{5}}) {
    const Bytes file = testing::serialized_file(version);
    for (int64_t index = 0; index < 2; ++index) {
      uint64_t inflatable = mitsuba::largest_inflated(file.size());
      const Mesh mesh = mitsuba::read_serialized(file, index, "a.serialized", inflatable);
      EXPECT_LT(inflatable, mitsuba::largest_inflated(file.size()));
      EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {index == 0 ? 1 : 5, 0, 0}, {0, 1, 0}})) << version;
      EXPECT_EQ(mesh.uv0.at(2), Vec2(0.25f, 0.5f));
      EXPECT_EQ(mesh.triangles, std::vector<UVec3>{UVec3(0, 1, 2)});
      EXPECT_EQ(mesh.normals.empty(), version != 5);
    }
    uint64_t inflatable = mitsuba::largest_inflated(file.size());
    EXPECT_NE(
        error_of([&] { mitsuba::read_serialized(file, 2, "a", inflatable); }).find("shape_index 2 does not exist"),
        std::string::npos);
  }
}

TEST(MitsubaShapes, MirroredSpheresFaceInwards) {
  const auto outwards = [](const std::string& shape) {
    const Mesh mesh = load_mitsuba_text("<shape type=\"sphere\">" + shape + "</shape>").meshes.at(0);
    return glm::dot(mesh.normals[200], mesh.positions[200]);
  };
  const std::string mirror = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
  EXPECT_GT(outwards(""), 0.9f);
  EXPECT_LT(outwards(mirror), -0.9f);
  EXPECT_LT(outwards("<float name=\"radius\" value=\"-2\"/>"), -0.9f);
  EXPECT_GT(outwards(mirror + "<boolean name=\"flip_normals\" value=\"true\"/>"), 0.9f);
}

TEST(MitsubaShapes, GroupsBecomeInstances) {
  const Scene scene = load_mitsuba_text(
      "<shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"><transform name=\"to_world\"><scale "
      "value=\"2\"/></transform></shape>"
      "<shape type=\"sphere\"/></shape>"
      "<shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><translate x=\"5\"/></transform></shape>"
      "<shape type=\"instance\"><ref id=\"g\"/></shape>");
  ASSERT_EQ(scene.nodes.size(), 2u);
  ASSERT_EQ(scene.nodes[0].instances.size(), 2u);
  EXPECT_EQ(Vec3(scene.nodes[0].instances[0] * Vec4(1, 0, 0, 1)), Vec3(7, 0, 0));
  EXPECT_EQ(Vec3(scene.nodes[1].instances[0] * Vec4(1, 0, 0, 1)), Vec3(6, 0, 0));
  const Scene alone = load_mitsuba_text("<shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"/></shape>");
  EXPECT_TRUE(alone.nodes.empty());
}

TEST(MitsubaShapes, EqualShapesShareMeshes) {
  const std::string bsdf = "<bsdf type=\"diffuse\" id=\"";
  const std::string sphere = "<shape type=\"sphere\"><ref id=\"";
  const Scene scene = load_mitsuba_text(bsdf + "a\"/>" + bsdf + "b\"/>" + sphere + "a\"/></shape>" + sphere +
                                        "a\"/></shape>" + sphere + "b\"/></shape>");
  EXPECT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.nodes.size(), 3u);
}

TEST(MitsubaShapes, UnusableTransformsLeaveOutTheirShape) {
  const Scene scene = load_mitsuba_text(
      "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"1e300\"/></transform></shape>"
      "<shape type=\"cube\"><transform name=\"to_world\"><matrix value=\"1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 "
      "1\"/></transform></shape>");
  EXPECT_TRUE(scene.nodes.empty());
  EXPECT_TRUE(mentions(scene.warnings, "is not affine or reaches beyond"));
}

}  // namespace
}  // namespace relume
