// Guards against libraries that crash on damaged files.
#pragma once

#include <cstdint>
#include <functional>

namespace relume {

/// Runs `task` in a child process that may use `cpu_seconds` and allocate `memory_bytes`, and returns whether it came
/// to an end, be it with an exception. It does not outlive the calling thread. `task` must not use threads of the
/// parent (TBB). Throws Error if no process can be made.
bool survives_trial(const std::function<void()>& task, uint64_t cpu_seconds, uint64_t memory_bytes);

}  // namespace relume
