// A device that executes the compiled code of kernels: a GPU, or the device that tests emulate. Backend sends all
// launches to it. Its code is the PTX of frame/cuda/device_code.h.
//
// A device has one queue. It executes launches one after the other, in their order, and while the host does other work.
// Host code and launches access the same memory, at different times: the host waits for the queued launches first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/array.h"
#include "frame/device_display.h"
#include "frame/tile.h"
#include "relume/statistics.h"

namespace relume {

/// One call of a kernel for each element of a window.
struct DeviceLaunch {
  std::string_view name;    ///< of the launch, for messages
  std::string_view kernel;  ///< the C++ type, as kernel_type_name() writes it: "relume::FillElementsKernel<float>"
  uint32_t threads = 0;     ///< of a group, for group kernels; 0: a pass kernel, with one thread per element
  std::span<const std::byte> argument = {};  ///< the kernel, with zeroed padding; at most 4 KiB
  Tile window = {};                          ///< at least one element
  /// Whether the device may keep the launch, and begin it together with later ones: once it gets one without this mark,
  /// has enough of them, or anyone waits for launches or accesses its memory.
  bool may_wait = false;
};

/// Edges of a rectangle of elements.
struct ElementBlock {
  uint32_t width = 1;
  uint32_t height = 1;
};

/// Used by one backend. One thread at a time calls its functions. Any thread may call those of its memory.
class Device {
 public:
  virtual ~Device() = default;

  /// Memory that its kernels and the host access. It lives as long as the device. deallocate() and the functions that
  /// give the host access wait for all queued launches first. All but deallocate() throw as finish().
  virtual Memory& memory() = 0;

  /// Number of threads that it executes at the same time: a launch of fewer threads hardly takes less time. At least 1.
  virtual uint32_t parallel_threads() const = 0;

  /// Elements of pass kernels that it executes together, in a window of this size. Parts of the window should have
  /// multiples of these edges: other parts leave threads without an element.
  virtual ElementBlock block(const Tile& /*window*/) const { return {}; }

  /// Queues a launch. Copies everything that `launch` refers to. Throws Error if the device cannot accept it, or as
  /// finish() for an earlier launch. Launches that have not begun when another fails are dropped.
  virtual void launch(const DeviceLaunch& launch) = 0;

  /// Waits until at most `launches` queued launches have not ended. Throws as finish().
  virtual void wait(size_t launches) = 0;

  /// Waits for all queued launches. Throws Error if one of them failed; those queued after it may not have run, and
  /// none is queued any more. After an error that the device does not survive, every function throws it again.
  virtual void finish() = 0;

  /// Times that the device took for launches, seconds: one for each launch that has ended since the last call, in their
  /// order. The times of launches before an error are lost.
  virtual std::vector<double> take_times() = 0;

  /// Time that it took to move memory before these launches, in addition to their times, seconds, since the last call.
  virtual double take_move_time() { return 0; }

  /// Its name, driver and memory, also after an error; absent for a device without a driver.
  virtual std::optional<DeviceStatistics> statistics() const { return std::nullopt; }

  /// Copies `bytes` from an address in a block of its memory for a window, after the queued launches, and does not wait
  /// for the copy. Returns nullptr if it cannot, or lacks the memory. Throws as finish() if an earlier launch or the
  /// device has failed.
  virtual std::shared_ptr<DeviceImage> copy_image(const void* /*pixels*/, size_t /*bytes*/) { return nullptr; }
};

}  // namespace relume
