// Sends launches to a device in bands, so that a stop is answered soon, and collects their times.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <string_view>

#include "frame/device.h"

namespace relume {

class DeviceQueue {
 public:
  /// `device` must outlive the queue. `add_time(name, seconds)`: called for each band that has ended, with the name of
  /// its launch and the time that the device took.
  DeviceQueue(Device& device, std::function<void(std::string_view name, double seconds)> add_time);
  /// Waits for all launches.
  ~DeviceQueue();
  DeviceQueue(const DeviceQueue&) = delete;
  DeviceQueue& operator=(const DeviceQueue&) = delete;

  Device& device() const { return device_; }

  /// Queues a launch. If `stop` can be requested, divides it into bands of rows, or of columns if it has one row, and
  /// returns false if `stop` was requested before all were queued. The queue then holds little work (kQueueSeconds).
  /// Calls `before_band` before each band. Throws as the device; the queue is then empty.
  bool launch(const DeviceLaunch& launch, const std::stop_token& stop, const std::function<void()>& before_band);

  /// Waits for all launches. Throws as Device::finish(); the queue is then empty.
  void finish();

 private:
  /// A band in the queue.
  struct Band {
    std::string name;
    std::string kernel;
    double threads;     ///< that take its time
    double expected_s;  ///< estimated time
  };

  bool launch_bands(const DeviceLaunch& launch, const std::stop_token& stop, const std::function<void()>& before_band);
  void add(const DeviceLaunch& band);
  /// Waits until the queue is expected to be empty after kQueueSeconds.
  void make_room();
  void collect_times();
  /// Waits for all launches and forgets them.
  void discard() noexcept;
  /// Number of threads of a kernel that the device executes in kBandSeconds.
  uint64_t band_threads(std::string_view kernel) const;

  Device& device_;
  std::function<void(std::string_view, double)> add_time_;
  std::deque<Band> bands_;
  double expected_s_ = 0;                                      ///< sum over the bands
  std::map<std::string, double, std::less<>> thread_seconds_;  ///< time of a band per thread, by kernel
};

}  // namespace relume
