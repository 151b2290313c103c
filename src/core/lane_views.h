// Loads and stores elements i (T = float) or i … i + kLanes − 1 (T = Lanes) of views of numbers, vectors and pairs.
#pragma once

#include <type_traits>

#include "core/triple.h"
#include "core/view.h"

namespace relume {

template <typename T>
RELUME_HD_INLINE T number_at(const View<const float>& values, uint32_t i) {
  return load_lanes<T>(&values[i]);
}
template <typename T>
RELUME_HD_INLINE void set_number(const View<float>& values, uint32_t i, const T& number) {
  store_lanes(&values[i], number);
}

/// The counts as floating-point numbers, exact up to 2^24.
template <typename T>
RELUME_HD_INLINE T count_at(const View<const uint32_t>& values, uint32_t i) {
  if constexpr (std::is_same_v<T, Lanes>) {
    Lanes n;
    for (uint32_t k = 0; k < kLanes; ++k) n.v[k] = static_cast<float>(static_cast<int>(values[i + k]));
    return n;
  } else {
    return static_cast<T>(static_cast<int>(values[i]));
  }
}

template <typename T>
RELUME_HD_INLINE Triple<T> vector_at(const View<const Vec3>& values, uint32_t i) {
  if constexpr (std::is_same_v<T, Lanes>) {
    Lanes v[3];
    load_vectors(&values[i].x, v);
    return {v[0], v[1], v[2]};
  } else {
    return triple_of<T>(values[i]);
  }
}
template <typename T>
RELUME_HD_INLINE void set_vector(const View<Vec3>& values, uint32_t i, const Triple<T>& v) {
  if constexpr (std::is_same_v<T, Lanes>) {
    store_vectors(&values[i].x, v.x, v.y, v.z);
  } else {
    values[i] = {v.x, v.y, v.z};
  }
}

template <typename T>
RELUME_HD_INLINE void get_pair(const View<const Vec2>& values, uint32_t i, T (&pair)[2]) {
  if constexpr (std::is_same_v<T, Lanes>) {
    load_pairs(&values[i].x, pair);
  } else {
    pair[0] = values[i].x;
    pair[1] = values[i].y;
  }
}

}  // namespace relume
