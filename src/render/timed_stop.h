// Stop requests after a time limit.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

namespace relume {

/// Requests a stop when `outer` does or after `seconds`, whichever is first.
class TimedStop {
 public:
  /// `seconds` 0: no time limit.
  TimedStop(std::stop_token outer, double seconds);

  std::stop_token token() const { return source_.get_token(); }

 private:
  void wait(const std::stop_token& end, double seconds);

  std::stop_source source_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::stop_callback<std::function<void()>> outer_;
  std::jthread timer_;  ///< last, because it uses the other members
};

}  // namespace relume
