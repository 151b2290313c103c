// Times within the shutter, and linear interpolation between its keys.
#pragma once

#include "core/vec.h"

namespace relume {

/// Time of a ray as a fraction of the shutter, from its opening at 0 to its closing at 1. The middle is the time of the
/// frame: rays outside of paths see the scene as the frame poses it.
inline constexpr float kShutterMiddle = 0.5f;

/// Offset of keys that do not exist: what refers to it rests while the shutter is open.
inline constexpr uint32_t kNoKeys = 0xffffffffu;

/// Two successive keys, at equal steps of time from 0 to 1, and the share of the second.
struct KeyTime {
  uint32_t first = 0;
  float share = 0;

  KeyTime() = default;
  /// `keys`: their number, at least 2. The formula is Embree's, so that both find the same keys and share.
  RELUME_HD KeyTime(float time, uint32_t keys) {
    const float scaled = time * static_cast<float>(keys - 1);
    const float whole = std::floor(relume::max(scaled, 0.0f));
    first = relume::min(static_cast<uint32_t>(whole), keys - 2);
    share = scaled - static_cast<float>(first);
  }

  /// Value between two keys. It equals the first where the share is zero: the middle of an odd number of keys is exact.
  template <typename T>
  RELUME_HD T mix(const T& a, const T& b) const {
    return a * (1.0f - share) + b * share;
  }
};

}  // namespace relume
