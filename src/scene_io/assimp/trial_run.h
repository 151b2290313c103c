// Runs code that may crash, hang or exhaust memory on damaged files in a child process.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "files/bytes.h"

namespace relume {

/// Limits of the child process.
struct TrialLimits {
  uint64_t cpu_s = 0;         ///< processor time of all threads
  double wall_s = 0;          ///< elapsed time
  uint64_t memory_bytes = 0;  ///< in addition to the memory of the calling process
};

/// Runs `task` in a child process and returns its result. The child does not outlive the calling thread. `task` must
/// not use threads of the parent (TBB). Throws Error with `place`, the file that `task` reads, if the child exceeds a
/// limit, crashes, throws, or cannot be started.
Bytes run_trial(const std::function<Bytes()>& task, const TrialLimits& limits, const std::string& place);

}  // namespace relume
