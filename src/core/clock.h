// The clock by which durations are measured.
#pragma once

#include <chrono>

namespace relume {

/// Seconds on a clock that only moves forward; its zero means nothing.
inline double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace relume
