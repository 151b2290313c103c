#include "viewer/model/fly_camera.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "scene/scene.h"

namespace relume::viewer {
namespace {

constexpr float kFov = 0.8f;
constexpr float kTolerance = 1e-5f;  // rounding in single precision

FlyCamera camera_at(const Vec3& eye, const Vec3& target) {
  const Transform t = look_at(eye, target);
  FlyCamera camera;
  camera.place(t.translation, t.rotation);
  return camera;
}

void expect_near(const Vec3& a, const Vec3& b) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], kTolerance) << i;
}

TEST(FlyCamera, KeepsAGivenPose) {
  const Mat4 pose = glm::translate(Mat4(1), Vec3(1, 2, 3)) * glm::rotate(Mat4(1), 0.7f, glm::normalize(Vec3(1, 2, 1)));
  FlyCamera camera;
  camera.place(glm::scale(pose, Vec3(2, 3, 4)));  // a camera ignores scale
  for (int c = 0; c < 4; ++c) expect_near(Vec3(camera.to_world()[c]), Vec3(pose[c]));
}

TEST(FlyCamera, FliesForwardSidewaysAndUp) {
  FlyCamera camera = camera_at({0, 0, 0}, {1, 0, 0});
  camera.speed = 2;
  EXPECT_TRUE(camera.update({.move = {0, 0, -1}}, 0.5f, kFov, 720));
  expect_near(camera.eye(), {1, 0, 0});
  camera.update({.move = {1, 0, 0}}, 0.5f, kFov, 720);
  expect_near(camera.eye(), {1, 0, 1});  // right of +X is +Z
  camera.update({.move = {0, 1, 0}, .fast = true}, 0.5f, kFov, 720);
  expect_near(camera.eye(), {1, 5, 1});
}

TEST(FlyCamera, RisesVerticallyInAnyViewDirection) {
  FlyCamera camera = camera_at({0, 0, 0}, {1, -1, 0});
  camera.update({.move = {0, 1, 0}}, 1, kFov, 720);
  expect_near(camera.eye(), {0, 1, 0});
}

TEST(FlyCamera, TurnsByTheAngleOfThePixels) {
  FlyCamera camera = camera_at({0, 0, 0}, {0, 0, -1});
  camera.update({.turn_px = {100, 0}}, 0.01f, kFov, 720);
  const float angle = kFov * 100 / 720;
  expect_near(camera.forward(), {std::sin(angle), 0, -std::cos(angle)});
  EXPECT_NEAR((camera.rotation() * Vec3(1, 0, 0)).y, 0, kTolerance) << "the horizon stays level";
}

TEST(FlyCamera, DoesNotTumbleOverTheZenith) {
  FlyCamera camera = camera_at({0, 0, 0}, {0, 0, -1});
  for (int i = 0; i < 100; ++i) camera.update({.turn_px = {0, -200}}, 0.01f, kFov, 720);
  EXPECT_GT(camera.forward().y, 0.99f);
  EXPECT_GT((camera.rotation() * Vec3(0, 1, 0)).y, 0) << "still upright";
  EXPECT_NEAR(glm::length(camera.rotation()), 1, kTolerance);
}

TEST(FlyCamera, ReportsNoChange) {
  FlyCamera camera;
  EXPECT_FALSE(camera.update({}, 1, kFov, 720));
}

}  // namespace
}  // namespace relume::viewer
