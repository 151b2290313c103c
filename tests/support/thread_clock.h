// The clock for durations that other processes do not affect.
#pragma once

#include <time.h>

namespace relume::support {

/// CPU time of the calling thread, seconds.
inline double thread_s() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace relume::support
