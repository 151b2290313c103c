#include "viewer/model/orbit_camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/framing.h"
#include "scene/scene.h"
#include "viewer/model/fly_camera.h"

namespace relume::viewer {
namespace {

constexpr float kTolerance = 1e-4f;
const Vec3 kPivot(1, 2, 3);
constexpr DollyRange kRange{0.1f, 50};

CameraPose camera_at(const Vec3& eye, const Vec3& target) {
  const Transform t = look_at(eye, target);
  FlyCamera pose;
  pose.place(t.translation, t.rotation);
  CameraPose camera;
  camera.to_world = pose.to_world();
  return camera;
}

Vec3 eye_of(const CameraPose& camera) { return Vec3(camera.to_world[3]); }

/// Position of a point in the image, (0, 0) its middle and 1 half its height.
Vec2 seen_at(const CameraPose& camera, const Vec3& p) {
  const float half = 0.5f * view_height(camera.camera, depth_of(camera, p));
  const Vec3 d = p - eye_of(camera);
  return Vec2(glm::dot(d, Vec3(camera.to_world[0])), glm::dot(d, Vec3(camera.to_world[1]))) / half;
}

void expect_near(const Vec3& a, const Vec3& b) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], kTolerance) << i;
}

TEST(Orbit, GoesAroundThePivotAndKeepsItInPlace) {
  CameraPose camera = camera_at(kPivot + Vec3(0.5f, 1, 4), kPivot + Vec3(0.3f, 0, 0));
  const Vec2 before = seen_at(camera, kPivot);
  const float distance = glm::length(eye_of(camera) - kPivot);
  for (int i = 0; i < 7; ++i) {
    orbit(camera, kPivot, {0.13f, 0.02f});
    EXPECT_NEAR(glm::length(eye_of(camera) - kPivot), distance, kTolerance);
    EXPECT_NEAR(seen_at(camera, kPivot).x, before.x, kTolerance);
    EXPECT_NEAR(seen_at(camera, kPivot).y, before.y, kTolerance);
    EXPECT_NEAR(camera.to_world[0].y, 0, kTolerance) << "the horizon stays level";
  }
}

TEST(Orbit, OneHeightOfTheImageIsHalfATurn) {
  CameraPose camera = camera_at(kPivot + Vec3(0, 0, 4), kPivot);
  orbit(camera, kPivot, {0.5f, 0});
  expect_near(eye_of(camera), kPivot + Vec3(-4, 0, 0));
  orbit(camera, kPivot, {0.5f, 0});
  expect_near(eye_of(camera), kPivot + Vec3(0, 0, -4));
}

TEST(Orbit, StopsBeforeTheZenith) {
  CameraPose camera = camera_at(kPivot + Vec3(0, 0, 4), kPivot);
  for (int i = 0; i < 20; ++i) orbit(camera, kPivot, {0, 0.2f});
  EXPECT_GT(eye_of(camera).y, kPivot.y + 3.9f) << "dragging down shows the object from above";
  EXPECT_GT(camera.to_world[1].y, 0) << "still upright";
}

/// Looking straight down and with a tilted horizon: neither may make a drag jump.
TEST(Orbit, KeepsThePivotInPlaceWhereverUpIs) {
  CameraPose down = camera_at(kPivot + Vec3(0, 0, 4), kPivot + Vec3(0.3f, 0.1f, 0));
  down.to_world = glm::mat4_cast(glm::angleAxis(-0.5f * kPi, Vec3(1, 0, 0)));
  down.to_world[3] = Vec4(kPivot + Vec3(0.3f, 4, 0.2f), 1);
  CameraPose rolled = camera_at(kPivot + Vec3(0.5f, 1, 4), kPivot + Vec3(0.3f, 0, 0));
  rolled.to_world *= glm::mat4_cast(glm::angleAxis(0.7f, Vec3(0, 0, 1)));
  for (CameraPose camera : {down, rolled}) {
    const Vec2 before = seen_at(camera, kPivot);
    const float distance = glm::length(eye_of(camera) - kPivot);
    for (int i = 0; i < 7; ++i) {
      const Vec3 eye = eye_of(camera);
      orbit(camera, kPivot, {0.05f, 0.02f});
      EXPECT_LT(glm::length(eye_of(camera) - eye), 0.3f * distance) << i;
      EXPECT_NEAR(glm::length(eye_of(camera) - kPivot), distance, kTolerance);
      EXPECT_NEAR(glm::length(seen_at(camera, kPivot) - before), 0, 10 * kTolerance);
    }
  }
}

TEST(OnScreen, IsInsideTheImage) {
  CameraPose camera = camera_at({0, 0, 4}, {0, 0, 0});
  camera.camera.fov_y_rad = 0.5f * kPi;  // the image shows 8 by 16 metres at the origin
  EXPECT_TRUE(is_on_screen(camera, {0, 0, 0}, 2));
  EXPECT_TRUE(is_on_screen(camera, {7.9f, -3.9f, 0}, 2));
  EXPECT_FALSE(is_on_screen(camera, {8.1f, 0, 0}, 2));
  EXPECT_FALSE(is_on_screen(camera, {0, 4.1f, 0}, 2));
  EXPECT_FALSE(is_on_screen(camera, {0, 0, 5}, 2)) << "behind the camera";
  EXPECT_FALSE(is_on_screen(camera, {0, 0, 4}, 2)) << "at the camera";
  camera.camera.projection = Projection::orthographic;
  camera.camera.half_height = 1;
  EXPECT_TRUE(is_on_screen(camera, {1.9f, 0.9f, 0}, 2));
  EXPECT_FALSE(is_on_screen(camera, {0, 1.1f, 0}, 2));
}

TEST(PivotAhead, LiesStraightAheadEvenIfThePointDoesNot) {
  const CameraPose camera = camera_at({0, 0, 4}, {0, 0, 0});
  expect_near(pivot_ahead(camera, {3, 1, 1}, 0.5f), {0, 0, 1});
  expect_near(pivot_ahead(camera, {0, 0, 9}, 0.5f), {0, 0, 3.5f});
  expect_near(pivot_ahead(camera, {0, 0, 4}, 0.5f), {0, 0, 3.5f});
}

TEST(Pan, PivotFollowsTheMouse) {
  CameraPose camera = camera_at(kPivot + Vec3(2, 1, 4), kPivot);
  Vec3 pivot = kPivot;
  pan(camera, pivot, {0.25f, -0.1f});
  EXPECT_NEAR(seen_at(camera, kPivot).x, 0.5f, kTolerance);
  EXPECT_NEAR(seen_at(camera, kPivot).y, 0.2f, kTolerance);
  EXPECT_NEAR(seen_at(camera, pivot).x, 0, kTolerance) << "the pivot comes along";
}

TEST(Dolly, ChangesTheDistanceByAShareAndStopsBeforeThePivot) {
  CameraPose camera = camera_at(kPivot + Vec3(0, 0, 4), kPivot);
  dolly(camera, kPivot, 1, kRange);
  const float nearer = glm::length(eye_of(camera) - kPivot);
  EXPECT_LT(nearer, 3.6f);
  dolly(camera, kPivot, -1, kRange);
  expect_near(eye_of(camera), kPivot + Vec3(0, 0, 4));
  dolly(camera, kPivot, 1000, kRange);
  EXPECT_NEAR(glm::length(eye_of(camera) - kPivot), 0.1f, kTolerance);
  dolly(camera, kPivot, -3, kRange);
  EXPECT_GT(glm::length(eye_of(camera) - kPivot), 0.15f) << "there is a way back";
  dolly(camera, kPivot, -1000, kRange);
  EXPECT_NEAR(glm::length(eye_of(camera) - kPivot), 50, kTolerance);
}

TEST(Dolly, LeavesThePivotBackwards) {
  CameraPose camera = camera_at(kPivot, kPivot + Vec3(0, 0, -1));
  dolly(camera, kPivot, 1, kRange);
  expect_near(eye_of(camera), kPivot);
  dolly(camera, kPivot, -1, kRange);
  expect_near(eye_of(camera), kPivot + Vec3(0, 0, 0.1f));
}

TEST(Dolly, DoesNotJumpIntoTheRange) {
  CameraPose camera = camera_at(kPivot + Vec3(0, 0, 200), kPivot);
  dolly(camera, kPivot, -1, kRange);
  expect_near(eye_of(camera), kPivot + Vec3(0, 0, 200));
  dolly(camera, kPivot, 1, kRange);
  EXPECT_NEAR(glm::length(eye_of(camera) - kPivot), 170, 0.01f);
}

TEST(Dolly, AnOrthographicCameraShowsLess) {
  CameraPose camera = camera_at(kPivot + Vec3(0, 0, 4), kPivot);
  camera.camera.projection = Projection::orthographic;
  dolly(camera, kPivot, 2, kRange);
  EXPECT_LT(camera.camera.half_height, 0.8f);
  dolly(camera, kPivot, -1000, kRange);
  EXPECT_NEAR(camera.camera.half_height, 50, kTolerance);
  expect_near(eye_of(camera), kPivot + Vec3(0, 0, 4));
}

class Frame : public ::testing::TestWithParam<Projection> {};

TEST_P(Frame, FillsTheImageWithTheBox) {
  Box box;
  box.add(Vec3(-1, 0, -2));
  box.add(Vec3(3, 0.5f, 1));
  constexpr float kAspect = 1.5f;
  for (const Vec3& from : {Vec3(1, 1, 1), Vec3(-20, 3, 0.1f), Vec3(0.1f, 30, 0)}) {
    CameraPose camera = camera_at(box.center() + from, box.center() + Vec3(0.2f, 0, 0));
    camera.camera.projection = GetParam();
    const Vec4 forward = camera.to_world[2];
    frame_box(camera, box, kAspect);
    expect_near(Vec3(camera.to_world[2]), Vec3(forward));
    Vec2 most(0);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p((corner & 1) != 0 ? box.high.x : box.low.x, (corner & 2) != 0 ? box.high.y : box.low.y,
                   (corner & 4) != 0 ? box.high.z : box.low.z);
      EXPECT_GT(depth_of(camera, p), 0);
      most = glm::max(most, glm::abs(seen_at(camera, p)) / Vec2(kAspect, 1));
    }
    EXPECT_NEAR(std::max(most.x, most.y), kFramedShare, 1e-3f);
  }
}

INSTANTIATE_TEST_SUITE_P(Projections, Frame, ::testing::Values(Projection::perspective, Projection::orthographic));

TEST(FrameBox, AnEmptyBoxChangesNothing) {
  CameraPose camera = camera_at({1, 2, 3}, {0, 0, 0});
  const Mat4 before = camera.to_world;
  frame_box(camera, {}, 1);
  EXPECT_EQ(camera.to_world, before);
}

}  // namespace
}  // namespace relume::viewer
