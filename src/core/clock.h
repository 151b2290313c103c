// The clock for measuring durations.
#pragma once

#include <chrono>

namespace relume {

/// Seconds on a monotonic clock with an arbitrary zero.
inline double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace relume
