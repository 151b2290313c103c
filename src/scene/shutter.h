// The shutter of the camera.
#pragma once

#include <cstdint>

namespace relume {

/// The shutter of all cameras. It is open for `seconds`, and the frame's time lies in the middle.
struct Shutter {
  float seconds = 0;  ///< 0: closed, nothing blurs
  int keys = 9;       ///< poses at equal steps of time, at least 2; made odd

  /// Closed shutters are equal.
  bool operator==(const Shutter& other) const { return seconds == other.seconds && (keys == other.keys || !is_open()); }
  bool is_open() const { return seconds > 0; }
  uint32_t key_count() const { return is_open() ? static_cast<uint32_t>(keys) | 1u : 0; }
};

}  // namespace relume
