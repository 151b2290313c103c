#include "viewer/model/orbit_camera.h"

#include <algorithm>
#include <cmath>

#include "scene/framing.h"
#include "viewer/model/fly_camera.h"

namespace relume::viewer {
namespace {

constexpr float kDollyStep = 0.85f;  // factor of the distance per notch of the wheel
constexpr float kMinDepth = 1e-4f;   // fraction of the distance to a pivot beside or behind the camera

/// The distance times `factor`, limited to the range without a jump if it was outside before.
float stepped(float distance, float factor, const DollyRange& range) {
  const float wanted = distance * factor;
  return factor < 1 ? std::min(distance, std::max(wanted, range.nearest))
                    : std::max(distance, std::min(std::max(wanted, range.nearest), range.farthest));
}

}  // namespace

float view_height(const Camera& camera, float depth) {
  if (camera.projection == Projection::orthographic) return 2 * camera.half_height;
  return 2 * depth * std::tan(0.5f * std::min(camera.fov_y_rad, 0.9f * kPi));
}

float depth_of(const CameraPose& camera, const Vec3& point) {
  return glm::dot(point - Vec3(camera.to_world[3]), -glm::normalize(Vec3(camera.to_world[2])));
}

bool is_on_screen(const CameraPose& camera, const Vec3& point, float aspect) {
  const float depth = depth_of(camera, point);
  if (!(depth > 0)) return false;
  if (camera.camera.projection == Projection::panoramic) return true;
  const float half = 0.5f * view_height(camera.camera, depth);
  const Vec3 d = point - Vec3(camera.to_world[3]);
  return std::fabs(glm::dot(d, glm::normalize(Vec3(camera.to_world[0])))) <= half * aspect &&
         std::fabs(glm::dot(d, glm::normalize(Vec3(camera.to_world[1])))) <= half;
}

Vec3 pivot_ahead(const CameraPose& camera, const Vec3& point, float nearest) {
  const float distance = std::max(depth_of(camera, point), nearest);
  return Vec3(camera.to_world[3]) - distance * glm::normalize(Vec3(camera.to_world[2]));
}

void orbit(CameraPose& camera, const Vec3& pivot, const Vec2& turn) {
  FlyCamera pose;
  pose.place(camera.to_world);
  const glm::quat before = pose.rotation();
  pose.turn(kPi * turn);
  const glm::quat change = pose.rotation() * glm::inverse(before);
  pose.place(pivot + change * (pose.eye() - pivot), pose.rotation());
  camera.to_world = pose.to_world();
}

void pan(CameraPose& camera, Vec3& pivot, const Vec2& by) {
  const float distance = glm::length(pivot - Vec3(camera.to_world[3]));
  const float height = view_height(camera.camera, std::max(depth_of(camera, pivot), kMinDepth * distance));
  const Vec3 right = glm::normalize(Vec3(camera.to_world[0]));
  const Vec3 up = glm::normalize(Vec3(camera.to_world[1]));
  const Vec3 shift = height * (up * by.y - right * by.x);
  camera.to_world[3] += Vec4(shift, 0);
  pivot += shift;
}

void dolly(CameraPose& camera, const Vec3& pivot, float notches, const DollyRange& range) {
  const float factor = std::pow(kDollyStep, notches);
  if (camera.camera.projection == Projection::orthographic) {
    camera.camera.half_height = stepped(camera.camera.half_height, factor, range);
    return;
  }
  const Vec3 from_pivot = Vec3(camera.to_world[3]) - pivot;
  const float distance = glm::length(from_pivot);
  const Vec3 direction = distance > 0 ? from_pivot / distance : glm::normalize(Vec3(camera.to_world[2]));
  camera.to_world[3] = Vec4(pivot + direction * stepped(distance, factor, range), 1);
}

void frame_box(CameraPose& camera, const Box& box, float aspect) {
  if (box.empty() || camera.camera.projection == Projection::panoramic) return;
  FlyCamera pose;
  pose.place(camera.to_world);
  const Mat3 axes(pose.to_world());
  const bool perspective = camera.camera.projection == Projection::perspective;
  const float tan_half = perspective ? std::tan(0.5f * camera.camera.fov_y_rad) : 0.0f;
  const Vec2 slope = kFramedShare * tan_half * Vec2(aspect, 1);
  // The nearest camera from which every corner (x, y, z) is in view: |x - eye.x| <= slope (eye.z - z), in its axes.
  Vec2 right(-kInfinity);
  Vec2 left(-kInfinity);
  float nearest = -kInfinity;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p((corner & 1) != 0 ? box.high.x : box.low.x, (corner & 2) != 0 ? box.high.y : box.low.y,
                 (corner & 4) != 0 ? box.high.z : box.low.z);
    const Vec3 local = glm::transpose(axes) * (p - box.center());
    right = glm::max(right, Vec2(local) + slope * local.z);
    left = glm::max(left, -Vec2(local) + slope * local.z);
    nearest = std::max(nearest, local.z);
  }
  const Vec2 middle = 0.5f * (right - left);
  const Vec2 half = 0.5f * (right + left);
  float distance = nearest + 0.5f * box.diagonal();
  if (perspective) {
    distance = std::max({half.x / slope.x, half.y / slope.y, nearest + 1e-3f * box.diagonal()});
  } else {
    camera.camera.half_height = std::max({half.x / aspect, half.y, 1e-6f}) / kFramedShare;
  }
  pose.place(box.center() + axes * Vec3(middle, distance), pose.rotation());
  camera.to_world = pose.to_world();
}

}  // namespace relume::viewer
