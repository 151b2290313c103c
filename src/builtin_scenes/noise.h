// Smooth random displacement for rock and foliage.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/hash.h"
#include "core/vec.h"

namespace relume {

/// Value noise in [-1, 1]: hashed values at integer points, blended by 3t² - 2t³.
inline float value_noise(const Vec3& p, uint32_t seed) {
  const Vec3 cell = glm::floor(p);
  const Vec3 f = p - cell;
  const Vec3 s = f * f * (3.0f - 2.0f * f);
  const auto corner = [&](int x, int y, int z) {
    const auto at = [](float base, int step) { return static_cast<uint32_t>(static_cast<int32_t>(base) + step); };
    return 2 * to_unit_float(hash(at(cell.x, x), at(cell.y, y), at(cell.z, z), seed)) - 1;
  };
  const auto along_x = [&](int y, int z) { return lerp(corner(0, y, z), corner(1, y, z), s.x); };
  return lerp(lerp(along_x(0, 0), along_x(1, 0), s.y), lerp(along_x(0, 1), along_x(1, 1), s.y), s.z);
}

/// Sum of `octaves` noises, each with twice the frequency and half the amplitude of the previous one.
inline float fractal_noise(Vec3 p, int octaves, uint32_t seed) {
  float sum = 0;
  float amplitude = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += amplitude * value_noise(p, seed + static_cast<uint32_t>(i));
    p *= 2.0f;
    amplitude *= 0.5f;
  }
  return sum;
}

}  // namespace relume
