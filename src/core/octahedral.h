// Unit vectors in 32 bits: the octahedral map with 16 bits per coordinate ([Cigolle14]).
#pragma once

#include "core/math.h"
#include "core/vec.h"

namespace relume {

/// Unit vector to the square [-1, 1]².
RELUME_HD inline Vec2 octahedral_from_direction(const Vec3& d) {
  const float s = 1.0f / (std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z));
  const Vec2 p{d.x * s, d.y * s};
  if (d.z >= 0.0f) return p;
  return {std::copysign(1.0f - std::fabs(p.y), p.x), std::copysign(1.0f - std::fabs(p.x), p.y)};
}

/// Square [-1, 1]² to the unit vector.
RELUME_HD inline Vec3 direction_from_octahedral(const Vec2& p) {
  Vec3 d{p.x, p.y, 1.0f - std::fabs(p.x) - std::fabs(p.y)};
  if (d.z < 0.0f) {
    const float x = d.x;
    d.x = std::copysign(1.0f - std::fabs(d.y), x);
    d.y = std::copysign(1.0f - std::fabs(x), d.y);
  }
  return glm::normalize(d);
}

RELUME_HD inline uint32_t pack_direction(const Vec3& d) {
  const Vec2 p = octahedral_from_direction(d);
  const auto quantise = [](float x) {
    return static_cast<uint32_t>(math::round_to_int((clamp(x, -1.0f, 1.0f) * 0.5f + 0.5f) * 65535.0f));
  };
  return quantise(p.x) | (quantise(p.y) << 16);
}

RELUME_HD inline Vec3 unpack_direction(uint32_t bits) {
  constexpr float kScale = 2.0f / 65535.0f;
  return direction_from_octahedral(
      {static_cast<float>(bits & 0xffffu) * kScale - 1.0f, static_cast<float>(bits >> 16) * kScale - 1.0f});
}

/// The octahedral map from unit vectors to the unit square, and its inverse.
RELUME_HD inline Vec2 square_from_direction(const Vec3& w) {
  const Vec2 p = octahedral_from_direction(w);
  return {clamp(0.5f * p.x + 0.5f, 0.0f, kOneMinusEpsilon), clamp(0.5f * p.y + 0.5f, 0.0f, kOneMinusEpsilon)};
}
RELUME_HD inline Vec3 direction_from_square(const Vec2& p) { return direction_from_octahedral(p * 2.0f - 1.0f); }

/// Solid angle per area of the square at direction `w`: 4 / |q|³, with q the point of the octahedron along `w`.
RELUME_HD inline float octahedral_solid_angle(const Vec3& w) {
  const float norm1 = std::fabs(w.x) + std::fabs(w.y) + std::fabs(w.z);  // |q| = 1 / norm1
  return 4.0f * norm1 * norm1 * norm1;
}

/// Maps a point up to one edge beyond the unit square to the point inside that continues the same path on the sphere.
/// Two points of an edge at the same distance from its middle are one direction.
RELUME_HD inline Vec2 wrap_square(Vec2 p) {
  if (p.x < 0.0f || p.x >= 1.0f) p = {p.x < 0.0f ? -p.x : 2.0f - p.x, 1.0f - p.y};
  if (p.y < 0.0f || p.y >= 1.0f) p = {1.0f - p.x, p.y < 0.0f ? -p.y : 2.0f - p.y};
  return {clamp(p.x, 0.0f, kOneMinusEpsilon), clamp(p.y, 0.0f, kOneMinusEpsilon)};
}

/// Packs 16 bits per coordinate of the unit square. unpack_square() returns the middle of the step, which lies in the
/// same cell of any quadtree of up to 16 levels.
RELUME_HD inline uint32_t pack_square(const Vec2& p) {
  return static_cast<uint32_t>(p.x * 65536.0f) | (static_cast<uint32_t>(p.y * 65536.0f) << 16);
}
RELUME_HD inline Vec2 unpack_square(uint32_t bits) {
  return {(static_cast<float>(bits & 0xffffu) + 0.5f) / 65536.0f, (static_cast<float>(bits >> 16) + 0.5f) / 65536.0f};
}

}  // namespace relume
