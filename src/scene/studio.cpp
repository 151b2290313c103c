#include "scene/studio.h"

#include <cmath>

#include "core/parallel.h"

namespace relume {
namespace {

constexpr float kDegree = kPi / 180.0f;

/// An emitting rectangle at infinity with soft edges.
struct SoftBox {
  float azimuth_deg;    ///< from +Z, the side of the camera, towards +X, its right
  float elevation_deg;  ///< above the horizon
  float half_width;     ///< tangent of the half angle
  float half_height;
  float radiance;  ///< at the centre
};

constexpr SoftBox kKey{-42, 42, 0.55f, 0.55f, 9.0f};
constexpr SoftBox kFill{62, 18, 0.75f, 0.9f, 1.5f};
constexpr SoftBox kRim{158, 38, 0.35f, 0.6f, 7.0f};
constexpr float kEdge = 0.12f;  ///< width of the edge, as a tangent

Vec3 direction(float azimuth_deg, float elevation_deg) {
  const float azimuth = azimuth_deg * kDegree;
  const float elevation = elevation_deg * kDegree;
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

float smooth_step(float low, float high, float x) {
  const float t = clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

float radiance_of(const SoftBox& box, const Vec3& w) {
  const Vec3 axis = direction(box.azimuth_deg, box.elevation_deg);
  const float along = glm::dot(w, axis);
  if (along <= 0.0f) return 0.0f;
  const Vec3 right = glm::normalize(glm::cross(Vec3(0, 1, 0), axis));
  const Vec3 up = glm::cross(axis, right);
  const auto inside = [&](const Vec3& side, float half) {
    return 1.0f - smooth_step(half - kEdge, half, std::fabs(glm::dot(w, side)) / along);
  };
  return box.radiance * inside(right, box.half_width) * inside(up, box.half_height);
}

/// Backdrop from the floor up: dark below, brightest at the horizon, dim above.
float backdrop(const Vec3& w) {
  constexpr float kFloor = 0.15f;
  constexpr float kHorizon = 0.5f;
  constexpr float kCeiling = 0.24f;
  const float horizon_share = 1.0f - smooth_step(0.0f, 0.75f, std::fabs(w.y));
  return lerp(w.y < 0.0f ? kFloor : kCeiling, kHorizon, horizon_share);
}

Rgb studio_radiance(const Vec3& w) {
  float sum = backdrop(w);
  for (const SoftBox& box : {kKey, kFill, kRim}) sum += radiance_of(box, w);
  return Rgb(sum);
}

}  // namespace

EnvironmentMap make_studio() {
  EnvironmentMap map{.width = 256, .height = 128, .texels = std::vector<Rgb>(256 * 128)};
  parallel_for(map.height, [&](int y) {
    const float theta = (static_cast<float>(y) + 0.5f) / static_cast<float>(map.height) * kPi;
    for (int x = 0; x < map.width; ++x) {
      const float phi = ((static_cast<float>(x) + 0.5f) / static_cast<float>(map.width) - 0.5f) * 2.0f * kPi;
      const Vec3 w(std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi));
      map.texels[static_cast<size_t>(int64_t{y} * map.width + x)] = studio_radiance(w);
    }
  });
  return map;
}

float studio_rotation_rad(const Vec3& forward) {
  if (sqr(forward.x) + sqr(forward.z) < 1e-6f * length_squared(forward)) return 0;
  return std::atan2(-forward.x, -forward.z);
}

}  // namespace relume
