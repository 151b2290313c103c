#include "render/timed_stop.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace relume {

TimedStop::TimedStop(std::stop_token outer, double seconds)
    : outer_(std::move(outer), [this] { source_.request_stop(); }) {
  if (seconds > 0) timer_ = std::jthread([this, seconds](const std::stop_token& end) { wait(end, seconds); });
}

void TimedStop::wait(const std::stop_token& end, double seconds) {
  constexpr double kLongest = 1e8;  // three years, within the range of the clock's nanoseconds
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, end, std::chrono::duration<double>(std::min(seconds, kLongest)), [] { return false; });
  if (!end.stop_requested()) source_.request_stop();
}

}  // namespace relume
