// Random numbers for tests: hashes of a counter, independent of the sequences under test.
#pragma once

#include "core/hash.h"
#include "core/vec.h"

namespace relume::testing {

class Random {
 public:
  explicit Random(uint32_t seed) : seed_(hash(seed, 0x7e57u)) {}

  float next() { return to_unit_float(hash(seed_, counter_++)); }
  uint32_t next_bits() { return hash(seed_, ~counter_++); }
  Vec2 next_2d() {
    const float x = next();
    return {x, next()};
  }
  /// Uniform over the unit sphere.
  Vec3 direction() {
    const float z = 1.0f - 2.0f * next();
    const float phi = 2.0f * kPi * next();
    const float r = safe_sqrt(1.0f - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
  /// Uniform over a cube of half-width `extent` about the origin.
  Vec3 point(float extent) {
    const float x = next();
    const float y = next();
    return (Vec3(x, y, next()) * 2.0f - 1.0f) * extent;
  }

 private:
  uint32_t seed_;
  uint32_t counter_ = 0;
};

}  // namespace relume::testing
