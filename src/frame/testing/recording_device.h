// A device for tests that records launches, and says how long they would take.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "frame/device.h"
#include "relume/error.h"

namespace relume::testing {

/// Ends launches when the host waits for them.
class RecordingDevice final : public Device {
 public:
  struct Recorded {
    std::string kernel;
    uint32_t threads;
    std::vector<std::byte> argument;
    Tile window;
    bool may_wait;
  };

  Memory& memory() override { return host_memory(); }
  uint32_t parallel_threads() const override { return parallel; }
  ElementBlock block(const Tile&) const override { return elements_of_block; }
  void launch(const DeviceLaunch& launch) override {
    if (fails_at == launches.size()) throw Error("the device is lost");
    launches.push_back({std::string(launch.kernel), launch.threads,
                        std::vector<std::byte>(launch.argument.begin(), launch.argument.end()), launch.window,
                        launch.may_wait});
    const uint64_t elements = uint64_t{launch.window.width()} * launch.window.height();
    queued_.push_back(element_s * static_cast<double>(std::max(elements, least_elements)));
    longest_queue_s = std::max(longest_queue_s, std::accumulate(queued_.begin(), queued_.end(), 0.0));
  }
  void wait(size_t count) override {
    fail_in(Step::wait);
    for (; queued_.size() > count; queued_.pop_front()) ended_.push_back(queued_.front());
  }
  void finish() override {
    fail_in(Step::finish);
    wait(0);
  }
  std::vector<double> take_times() override {
    fail_in(Step::times);
    return std::exchange(ended_, {});
  }
  double take_move_time() override { return std::exchange(move_s, 0); }
  size_t queued() const { return queued_.size(); }

  std::vector<Recorded> launches;
  uint32_t parallel = 100;
  ElementBlock elements_of_block;
  double element_s = 1e-4;
  uint64_t least_elements = 0;  ///< fewer elements take the same time
  double longest_queue_s = 0;
  double move_s = 0;
  enum class Step { none, wait, finish, times };
  Step fails_in = Step::none;  ///< once
  size_t fails_at = std::numeric_limits<size_t>::max();

 private:
  void fail_in(Step step) {
    if (fails_in != step) return;
    fails_in = Step::none;
    queued_.clear();
    ended_.clear();
    throw Error("a launch failed");
  }

  std::deque<double> queued_;
  std::vector<double> ended_;
};

}  // namespace relume::testing
