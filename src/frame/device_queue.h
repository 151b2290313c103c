// Sends launches to a device in bands, so that a stop is answered soon, and collects their times. Marks short launches
// that the device may begin together, of at most a band's time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>

#include "frame/device.h"

namespace relume {

class DeviceQueue {
 public:
  /// `device` must outlive the queue. `add_time(name, seconds)`: called for each band that has ended, with the name of
  /// its launch and the time that the device took; and with "moves" for memory that the device moved.
  DeviceQueue(Device& device, std::function<void(std::string_view name, double seconds)> add_time);
  /// Waits for all launches.
  ~DeviceQueue();
  DeviceQueue(const DeviceQueue&) = delete;
  DeviceQueue& operator=(const DeviceQueue&) = delete;

  Device& device() const { return device_; }

  /// Queues a launch. If `stop` can be requested, divides it into bands: rows, or columns of few rows where a row takes
  /// too long. Returns false if `stop` was requested before all were queued. The queue then holds little work
  /// (kQueueSeconds). Calls `before_band` before each band. Throws as the device; the queue is then empty.
  bool launch(const DeviceLaunch& launch, const std::stop_token& stop, const std::function<void()>& before_band);

  /// Waits for all launches. Throws as Device::finish(); the queue is then empty.
  void finish();

 private:
  /// Time of a kernel, from the bands of launches with one name that have ended.
  struct Estimate {
    double thread_s = 0;         ///< per thread; 0: unknown
    uint64_t most_threads = 32;  ///< of the next band, unless a block has more
  };
  /// A band in the queue.
  struct Band {
    std::string name;
    Estimate* estimate;
    uint64_t threads;
    double expected_s;  ///< estimated time
  };

  bool launch_bands(const DeviceLaunch& launch, const std::stop_token& stop, const std::function<void()>& before_band);
  /// `is_trial`: whether the next band waits for this one, which may show that it can be larger.
  void add(const DeviceLaunch& launch, Estimate& estimate, bool is_trial);
  Estimate& estimate_of(const DeviceLaunch& launch);
  /// Whether a launch takes the same time with more threads, up to parallel_threads().
  bool fills_device(const Estimate& estimate) const;
  double expected_seconds(const Estimate& estimate, uint64_t threads) const;
  /// Number of threads that the device executes in kBandSeconds; at least those that take no longer than one.
  uint64_t fitting_threads(const Estimate& estimate) const;
  void learn(Estimate& estimate, uint64_t threads, double seconds) const;
  /// Whether the device may keep a launch, with those that it keeps already.
  bool may_wait(double expected_s);
  /// Waits until the queue is expected to be empty after kQueueSeconds.
  void make_room();
  void collect_times();
  /// Waits for all launches and forgets them.
  void discard() noexcept;

  Device& device_;
  std::function<void(std::string_view, double)> add_time_;
  std::deque<Band> bands_;
  double expected_s_ = 0;                                              ///< sum over the bands
  double kept_s_ = 0;                                                  ///< the same for those that the device may keep
  std::map<std::pair<std::string, std::string>, Estimate> estimates_;  ///< by kernel and name of the launch
};

}  // namespace relume
