#include "scene_io/shapes/quadrics.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "core/vec.h"
#include "scene_io/shapes/grid.h"

namespace relume {
namespace {

/// Segments of a part of a turn.
int segments_of(float angle_rad, int per_turn) {
  const float share = std::clamp(std::fabs(angle_rad) / (2 * kPi), 0.0f, 1.0f);
  return std::max(3, static_cast<int>(std::ceil(share * static_cast<float>(per_turn))));
}

/// Cosine and sine of the azimuth; both ends of a full turn are the same point.
Vec2 azimuth(float u, float phi_max_rad) {
  const float phi = u >= 1 && phi_max_rad >= 2 * kPi * 0.99999f ? 0.0f : u * phi_max_rad;
  return {std::cos(phi), std::sin(phi)};
}

float valid_phi(float phi_max_rad) { return std::clamp(phi_max_rad, 1e-3f, 2 * kPi); }

}  // namespace

Mesh sphere_mesh(const SphereShape& shape, int segments) {
  const float radius = shape.radius;
  const float low = std::clamp(std::min(shape.z_min, shape.z_max), -radius, radius);
  const float high = std::clamp(std::max(shape.z_min, shape.z_max), -radius, radius);
  const float theta_low = std::acos(std::clamp(low / radius, -1.0f, 1.0f));
  const float theta_high = std::acos(std::clamp(high / radius, -1.0f, 1.0f));
  const float phi_max = valid_phi(shape.phi_max_rad);
  const auto vertex = [&](float u, float v) {
    const float theta = lerp(theta_low, theta_high, v);
    // Without the rounding error of sin(π), which would open the poles.
    const float sine = theta <= 0 || theta >= kPi * 0.9999999f ? 0.0f : std::sin(theta);
    const Vec3 normal(azimuth(u, phi_max) * sine, std::cos(theta));
    return GridVertex{normal * radius, normal};
  };
  return grid_mesh(segments_of(phi_max, segments), segments_of(theta_low - theta_high, segments), vertex);
}

Mesh disk_mesh(const DiskShape& shape, int segments) {
  const float phi_max = valid_phi(shape.phi_max_rad);
  const auto vertex = [&](float u, float v) {
    const float r = lerp(shape.radius, std::clamp(shape.inner_radius, 0.0f, shape.radius), v);
    return GridVertex{Vec3(azimuth(u, phi_max) * r, shape.height), Vec3(0, 0, 1)};
  };
  return grid_mesh(segments_of(phi_max, segments), 1, vertex);
}

Mesh cylinder_mesh(const CylinderShape& shape, int segments) {
  const float phi_max = valid_phi(shape.phi_max_rad);
  const auto vertex = [&](float u, float v) {
    const Vec2 direction = azimuth(u, phi_max);
    return GridVertex{Vec3(direction * shape.radius, lerp(shape.z_min, shape.z_max, v)), Vec3(direction, 0)};
  };
  return grid_mesh(segments_of(phi_max, segments), 1, vertex);
}

}  // namespace relume
