#include "scene/placement.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "relume/error.h"

namespace relume {
namespace {

Mat4 scaled(const Vec3& scale) { return glm::scale(Mat4(1), scale); }

TEST(Placement, DirectionsHaveUnitLengthHoweverShort) {
  EXPECT_EQ(direction_of(Vec3(0)), Vec3(0));
  for (const float length : {1e-30f, 1.0f, 1e9f}) EXPECT_EQ(direction_of(Vec3(0, -length, 0)), Vec3(0, -1, 0));
}

TEST(Placement, OrientationLeavesScaleAndShearOut) {
  const Mat4 turned = glm::rotate(Mat4(1), 0.7f, glm::normalize(Vec3(1, 2, 3)));
  for (const Vec3& scale : {Vec3(1), Vec3(1e-20f), Vec3(3, 0.5f, 7), Vec3(0, 2, 2), Vec3(1e9f)}) {
    const std::optional<Mat3> axes = orientation(turned * scaled(scale));
    ASSERT_TRUE(axes) << scale.x;
    for (int c = 0; c < 3; ++c) EXPECT_LT(glm::length((*axes)[c] - Vec3(turned[c])), 1e-5f) << scale.x;
  }
  Mat4 sheared(1);
  sheared[1] = Vec4(0, 1, 0.8f, 0);
  EXPECT_LT(glm::length((*orientation(sheared))[1] - Vec3(0, 1, 0)), 1e-6f);
}

TEST(Placement, CollapsedAxesHaveNoOrientation) {
  EXPECT_FALSE(orientation(scaled(Vec3(0))));
  EXPECT_FALSE(orientation(scaled(Vec3(1, 0, 1))));
  EXPECT_FALSE(orientation(scaled(Vec3(1, 1, 0))));
  Mat4 flat(1);
  flat[1] = flat[2];
  EXPECT_FALSE(orientation(flat));
}

Scene one_node(const Mat4& matrix) {
  Scene scene;
  scene.meshes.emplace_back();
  Node node;
  node.name = "far";
  node.matrix = matrix;
  node.meshes = {0};
  scene.add_node(node);
  return scene;
}

/// Message of validate() for the scene; empty: valid.
std::string problem_with(const Scene& scene) {
  try {
    validate(scene, "a.gltf");
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(Placement, ErrorsNameNodesBeyondTheLimit) {
  const Mat4 one(1);
  EXPECT_EQ(problem_with(one_node(glm::translate(one, Vec3(1e8f, 0, 0)))), "");
  for (const Mat4& matrix : {glm::translate(one, Vec3(0, 1e20f, 0)), scaled(Vec3(1, 1, 1e30f)), scaled(Vec3(kInfinity)),
                             glm::translate(one, Vec3(0, std::nanf(""), 0))}) {
    const std::string problem = problem_with(one_node(matrix));
    EXPECT_NE(problem.find("a.gltf: node 0 'far'"), std::string::npos) << problem;
    EXPECT_NE(problem.find("scale the scene down"), std::string::npos) << problem;
  }
  Scene nested = one_node(scaled(Vec3(1e6f)));  // each scale is valid, their product is not
  nested.nodes[0].parent = 1;
  nested.add_node(nested.nodes[0]);
  nested.nodes[1].parent = kNone;
  EXPECT_NE(problem_with(nested).find("node 0"), std::string::npos);
  Scene empty = one_node(scaled(Vec3(1e30f)));
  empty.nodes[0].meshes.clear();
  EXPECT_EQ(problem_with(empty), "");
}

TEST(Placement, ErrorsNameCamerasAndLightsOutOfRange) {
  const auto with_camera = [](const Camera& camera) {
    Scene scene;
    scene.cameras.push_back(camera);
    return problem_with(scene);
  };
  EXPECT_EQ(with_camera({}), "");
  EXPECT_NE(with_camera({.name = "c", .fov_y_rad = 0}).find("camera 'c' has a field of view"), std::string::npos);
  EXPECT_NE(with_camera({.name = "c", .half_height = 1e20f}).find("half height"), std::string::npos);
  EXPECT_NE(with_camera({.name = "c", .lens_radius = kInfinity}).find("lens radius"), std::string::npos);
  EXPECT_NE(with_camera({.name = "c", .focus_distance = 0}).find("focuses"), std::string::npos);
  const auto with_light = [](const PunctualLight& light) {
    Scene scene;
    scene.lights.push_back(light);
    return problem_with(scene);
  };
  EXPECT_EQ(with_light({}), "");
  EXPECT_NE(with_light({.name = "l", .intensity = Rgb(-1)}).find("light 'l' has an intensity"), std::string::npos);
  EXPECT_NE(with_light({.name = "l", .inner_cone_rad = 1, .outer_cone_rad = 0.5f}).find("cone"), std::string::npos);
  EXPECT_NE(with_light({.name = "l", .angular_diameter_rad = -1}).find("diameter"), std::string::npos);
}

}  // namespace
}  // namespace relume
