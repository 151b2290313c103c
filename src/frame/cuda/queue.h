// The queue of a device: work that it does in order, while the host does other work.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

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

  /// Calls `submit` where host code or other work needs the launches that the device keeps: `submit` gives them to the
  /// driver. The context is current then. Call this before other threads use the queue.
  void on_submit(std::function<void()> submit) { submit_ = std::move(submit); }
  /// Call it before work is queued that depends on launches. Throws as `submit`.
  void submit() const {
    if (submit_) submit_();
  }

  /// Call it after the driver has a launch. `name`: for messages.
  void launched(std::string_view name);
  /// Call it when the host knows that the oldest launch has ended, or that all have ended or failed.
  void oldest_ended();
  void all_ended();
  /// Call it after work is queued that accesses memory, or a launch is kept.
  void added() { ++added_; }
  /// Pieces of work that were queued so far.
  uint64_t queued() const { return added_.load(); }
  /// Whether the first `count` of them have ended, as far as the host knows.
  bool has_finished(uint64_t count) const { return finished_.load() >= count; }
  /// Whether no work is queued, as far as the host knows.
  bool idle() const { return finished_.load() >= added_.load(); }
  /// Waits for the work; returns at once if none is queued. The context must be current. Throws as check().
  void finish();
  /// Waits for all commands in the stream, without occupying a core. Otherwise as finish(). `action`: as for check().
  void wait_for_stream(std::string_view action);

  /// Throws unless `result` is success: DeviceMemoryError if the device is out of memory, else Error. `action`: what
  /// failed, for the sentence. The driver may report errors of earlier launches. After an error that the device does
  /// not survive, check_usable() throws it again.
  void check(Result result, std::string_view action);
  /// Returns whether `result` is success. Throws as check() only after an error that the device does not survive.
  bool accepts(Result result, std::string_view action);
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
  void create_objects();
  void destroy_objects() const;
  [[noreturn]] void fail(Result result, std::string_view action);

  const Driver& driver_;
  DeviceNumber device_;
  std::string device_name_;
  Context context_ = nullptr;
  Stream stream_ = nullptr;
  Event reached_ = nullptr;             ///< end of the commands that a thread waits for
  std::atomic<uint64_t> added_ = 0;     ///< pieces of work that were queued
  std::atomic<uint64_t> finished_ = 0;  ///< those whose work has ended
  std::atomic<bool> failed_ = false;
  std::function<void()> submit_;
  mutable std::mutex mutex_;          ///< guards the texts
  std::deque<std::string> launches_;  ///< in the queue
  std::string failure_;
};

}  // namespace relume::cuda
