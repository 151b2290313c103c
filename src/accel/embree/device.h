// An Embree device.
#pragma once

#include <atomic>
#include <cstddef>
#include <string>

#include "accel/embree/embree.h"

namespace relume::embree {

/// Owns a device, counts its memory, and keeps its last error. Not movable: Embree stores its address.
class Device {
 public:
  /// Throws Error if Embree cannot be started on this processor.
  Device();
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  RTCDevice get() const { return device_; }
  /// Throws Error if an error occurred since the last call, unless it was `ignored`.
  void check(RTCError ignored = RTC_ERROR_NONE);
  /// Bytes allocated by Embree.
  size_t memory_bytes() const { return static_cast<size_t>(bytes_.load()); }
  /// Version of the loaded library, such as "3.13.5".
  std::string version() const;

 private:
  RTCDevice device_ = nullptr;
  RTCError error_ = RTC_ERROR_NONE;
  std::string error_text_;
  std::atomic<int64_t> bytes_{0};
};

}  // namespace relume::embree
