// Memory of a GPU that the devices of a process share.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "frame/cuda/driver.h"

namespace relume::cuda {

/// Limit of the managed memory of all devices on one GPU. Managed memory takes room on the GPU only when a kernel
/// accesses it, so the driver's free memory does not show it. Thread-safe.
class MemoryBudget {
 public:
  explicit MemoryBudget(size_t limit) : limit_(limit) {}

  /// The budget of a GPU, shared with the other devices on it, or else a new one of `free_bytes()`. `shareable`:
  /// whether the GPU has concurrent access. Without it, host code must access no managed memory while a kernel of any
  /// device runs; this throws Error if another device exists. `device_name`: for its message.
  static std::shared_ptr<MemoryBudget> of_gpu(DeviceNumber device, bool shareable, const std::string& device_name,
                                              const std::function<size_t()>& free_bytes);

  /// Returns false if there is no room.
  bool take(size_t bytes);
  void give_back(size_t bytes);

  size_t used_bytes() const;
  size_t limit_bytes() const { return limit_; }

 private:
  size_t limit_;
  mutable std::mutex mutex_;  ///< guards the rest
  size_t used_ = 0;
};

}  // namespace relume::cuda
