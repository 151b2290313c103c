// Input of viewers on its way from the network's thread to the model's.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <utility>

#include "serve/message.h"

namespace relume::serve {

struct Input {
  uint32_t viewer = 0;
  Message message;
};

/// A bounded queue. A full one drops input, except that a viewer left.
class Inbox {
 public:
  static constexpr size_t kMost = 4096;

  void put(Input input) {
    const std::lock_guard lock(mutex_);
    const bool leaves = std::holds_alternative<Left>(input.message.body);
    if (inputs_.size() < kMost || leaves) inputs_.push_back(std::move(input));
    woken_ = true;
    wake_.notify_one();
  }

  /// Ends the present or next wait.
  void wake() {
    const std::lock_guard lock(mutex_);
    woken_ = true;
    wake_.notify_one();
  }

  /// Notes the number of connected viewers.
  void note_viewers(size_t count) {
    const std::lock_guard lock(mutex_);
    viewers_ = count;
    woken_ = true;
    wake_.notify_one();
  }
  size_t viewers() const {
    const std::lock_guard lock(mutex_);
    return viewers_;
  }

  /// Waits for input, wake(), or the time.
  void wait(double seconds) {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return woken_; });
    woken_ = false;
  }

  std::deque<Input> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(inputs_, {});
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Input> inputs_;
  size_t viewers_ = 0;
  bool woken_ = false;
};

}  // namespace relume::serve
