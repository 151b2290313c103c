// The queue of a device: work that it does in order, while the host does other work.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

#include "frame/cuda/driver.h"

namespace relume::cuda {

/// A stream in the primary context of a device, and the error that the device did not survive, if any. Thread-safe.
class Queue {
 public:
  /// `device_name`: for messages, such as "NVIDIA H100 (cuda:0)". `driver` must outlive the queue. Throws Error.
  Queue(const Driver& driver, DeviceNumber device, std::string device_name);
  /// Waits for the queued work.
  ~Queue();
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  /// Makes the context current on this thread for its lifetime, which most functions of the driver need. Throws as
  /// check_usable().
  class Current {
   public:
    explicit Current(const Queue& queue);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    const Queue& queue_;
  };

  const Driver& driver() const { return driver_; }
  DeviceNumber device() const { return device_; }
  const std::string& device_name() const { return device_name_; }
  Stream stream() const { return stream_; }

  /// Call it after each launch. `name`: for messages.
  void added(std::string_view name);
  /// Whether no launch is queued, as far as the host knows.
  bool idle() const { return finished_.load() >= added_.load(); }
  /// Waits for the launches; returns at once if none is queued. The context must be current. Throws as check().
  void finish();

  /// Throws unless `result` is success: DeviceMemoryError if the device is out of memory, else Error. `action`: what
  /// failed, for the sentence. The driver may report errors of earlier launches. After an error that the device does
  /// not survive, check_usable() throws it again.
  void check(Result result, std::string_view action);
  /// Throws Error if the device has failed.
  void check_usable() const;

  /// Calls f() to free objects of the driver, with the context current, also if the device has failed: errors are then
  /// of no use.
  template <typename F>
  void free_objects(const F& f) const noexcept {
    if (driver_.cuCtxPushCurrent(context_) != Result::success) return;
    f();
    Context popped = nullptr;
    driver_.cuCtxPopCurrent(&popped);
  }

 private:
  [[noreturn]] void fail(Result result, std::string_view action);

  const Driver& driver_;
  DeviceNumber device_;
  std::string device_name_;
  Context context_ = nullptr;
  Stream stream_ = nullptr;
  std::atomic<uint64_t> added_ = 0;     ///< number of calls of added()
  std::atomic<uint64_t> finished_ = 0;  ///< those whose work has ended
  std::atomic<bool> failed_ = false;
  mutable std::mutex mutex_;  ///< guards the texts
  std::string last_launch_ = "no kernel";
  std::string failure_;
};

}  // namespace relume::cuda
