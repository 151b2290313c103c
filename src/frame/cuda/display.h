// Images for windows: copies on the GPU, from which it writes textures, or page-locked memory.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>

#include "frame/cuda/managed_memory.h"
#include "frame/cuda/memory_budget.h"
#include "frame/cuda/queue.h"
#include "frame/device_display.h"

namespace relume::cuda {

/// Copies images to memory of its own in the order of launches, and from there in a queue of its own, while the device
/// executes other launches. It keeps the GPU's context until the last image and texture are gone.
class Display final : public DeviceDisplay, public std::enable_shared_from_this<Display> {
 public:
  /// Most images at a time: one that is shown, the newest, one that is copied, and one for the other thread.
  static constexpr size_t kImages = 4;

  /// Memory for an image.
  struct Slot {
    DeviceAddress copy = 0;  ///< on the GPU
    size_t copy_bytes = 0;
    void* locked = nullptr;  ///< page-locked host memory
    size_t locked_bytes = 0;
    Event copied = nullptr;  ///< after the copy to `copy`, in the queue of launches
    Event read = nullptr;    ///< after the last reading of `copy`, in the display's queue
    bool in_use = false;
  };

  /// `budget`: of the GPU's memory. Throws Error.
  Display(const Driver& driver, DeviceNumber device, const std::string& device_name,
          std::shared_ptr<MemoryBudget> budget);
  ~Display() override;
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  /// Queues a copy of `bytes` of a block of `memory`, after the launches of `queue`. Returns nullptr if all images are
  /// in use, or if memory is missing. Throws as Queue::check().
  std::shared_ptr<DeviceImage> copy(Queue& queue, ManagedMemory& memory, const void* pixels, size_t bytes);

  std::unique_ptr<DeviceTexture> share(uint32_t texture, size_t row_bytes, size_t rows) override;
  void keep_on_device(bool keep) override { keeps_on_device_.store(keep); }

  /// The display's own queue.
  Queue& queue() { return queue_; }
  /// Ends the use of a slot.
  void release(Slot& slot);

 private:
  /// A slot with memory for an image; nullptr if there is none.
  Slot* take(size_t bytes, bool needs_locked);
  /// Gives a slot the memory that it lacks. Returns false if there is not enough.
  bool grow(Slot& slot, size_t bytes, bool needs_locked);
  /// Frees the copy on the GPU once no queued work uses it.
  void free_copy(Slot& slot);
  /// Queues the copy to page-locked memory in the display's queue. Reports errors to `queue`.
  void copy_to_host(Queue& queue, const Slot& slot, size_t bytes);
  bool make_events(Slot& slot);
  /// Whether this GPU draws the OpenGL context of the calling thread.
  bool draws_window();

  std::shared_ptr<MemoryBudget> budget_;
  Queue queue_;
  std::atomic<bool> keeps_on_device_ = false;
  std::mutex mutex_;  ///< guards the use of slots
  std::array<Slot, kImages> slots_{};
};

}  // namespace relume::cuda
