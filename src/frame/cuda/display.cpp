#include "frame/cuda/display.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include "relume/error.h"

namespace relume::cuda {
namespace {

constexpr std::string_view kAction = "copying an image for a window";

/// Calls f() with the display's context current. Returns false if it does, or if the device has failed.
template <typename F>
bool succeeds(const Queue& queue, const F& f) {
  try {
    const Queue::Current current(queue);
    return f();
  } catch (const Error&) {
    return false;
  } catch (const DeviceMemoryError&) {
    return false;
  }
}

class CudaImage final : public DeviceImage {
 public:
  CudaImage(std::shared_ptr<Display> display, Display::Slot& slot, size_t bytes, bool is_locked)
      : display_(std::move(display)), shown_by_(display_), slot_(slot), bytes_(bytes), is_locked_(is_locked) {}
  ~CudaImage() override { display_->release(slot_); }
  CudaImage(const CudaImage&) = delete;
  CudaImage& operator=(const CudaImage&) = delete;

  const std::shared_ptr<DeviceDisplay>& display() const override { return shown_by_; }
  size_t size_bytes() const override { return bytes_; }
  std::span<const std::byte> bytes() override;
  bool read(size_t first, std::span<std::byte> to) override;

  Display::Slot& slot() { return slot_; }

 private:
  std::shared_ptr<Display> display_;
  std::shared_ptr<DeviceDisplay> shown_by_;  ///< the same
  Display::Slot& slot_;
  size_t bytes_;
  bool is_locked_;  ///< whether it is copied to page-locked memory
};

std::span<const std::byte> CudaImage::bytes() {
  Queue& queue = display_->queue();
  const bool complete = is_locked_ && succeeds(queue, [&] {
                          return queue.accepts(queue.driver().cuEventSynchronize(slot_.read), kAction);
                        });
  return complete ? std::span(static_cast<const std::byte*>(slot_.locked), bytes_) : std::span<const std::byte>{};
}

bool CudaImage::read(size_t first, std::span<std::byte> to) {
  if (is_locked_) {
    const std::span<const std::byte> all = bytes();
    if (!all.empty()) std::memcpy(to.data(), all.data() + first, to.size());
    return !all.empty();
  }
  Queue& queue = display_->queue();
  const Driver& driver = queue.driver();
  return succeeds(queue, [&] {
    return queue.accepts(driver.cuStreamWaitEvent(queue.stream(), slot_.copied, 0), kAction) &&
           queue.accepts(driver.cuMemcpyDtoHAsync(to.data(), slot_.copy + first, to.size(), queue.stream()), kAction) &&
           queue.accepts(driver.cuEventRecord(slot_.read, queue.stream()), kAction) &&
           queue.accepts(driver.cuEventSynchronize(slot_.read), kAction);
  });
}

class CudaTexture final : public DeviceTexture {
 public:
  CudaTexture(std::shared_ptr<Display> display, Texture texture, size_t row_bytes, size_t rows)
      : display_(std::move(display)), texture_(texture), row_bytes_(row_bytes), rows_(rows) {}
  ~CudaTexture() override {
    const Queue& queue = display_->queue();
    queue.free_objects([&] { queue.driver().cuGraphicsUnregisterResource(texture_); });
  }
  CudaTexture(const CudaTexture&) = delete;
  CudaTexture& operator=(const CudaTexture&) = delete;

  bool write(DeviceImage& image) override;

 private:
  /// The texture is mapped.
  bool copy(const Display::Slot& slot);

  std::shared_ptr<Display> display_;
  Texture texture_;
  size_t row_bytes_;
  size_t rows_;
};

bool CudaTexture::copy(const Display::Slot& slot) {
  Queue& queue = display_->queue();
  RowCopy rows{.from = {.device = slot.copy, .pitch_bytes = row_bytes_},
               .to = {.type = MemoryType::array},
               .row_bytes = row_bytes_,
               .rows = rows_};
  const Driver& driver = queue.driver();
  return queue.accepts(driver.cuGraphicsSubResourceGetMappedArray(&rows.to.array, texture_, 0, 0), kAction) &&
         queue.accepts(driver.cuMemcpy2DAsync(&rows, queue.stream()), kAction);
}

bool CudaTexture::write(DeviceImage& image) {
  if (image.display() != display_ || image.size_bytes() != row_bytes_ * rows_) return false;
  const Display::Slot& slot = static_cast<CudaImage&>(image).slot();
  Queue& queue = display_->queue();
  const Driver& driver = queue.driver();
  return succeeds(queue, [&] {
    const Stream stream = queue.stream();
    if (!queue.accepts(driver.cuStreamWaitEvent(stream, slot.copied, 0), kAction)) return false;
    if (!queue.accepts(driver.cuGraphicsMapResources(1, &texture_, stream), kAction)) return false;
    const bool is_copied = copy(slot);
    const bool is_unmapped = queue.accepts(driver.cuGraphicsUnmapResources(1, &texture_, stream), kAction);
    return queue.accepts(driver.cuEventRecord(slot.read, stream), kAction) && is_copied && is_unmapped;
  });
}

}  // namespace

Display::Display(const Driver& driver, DeviceNumber device, const std::string& device_name,
                 std::shared_ptr<MemoryBudget> budget)
    : budget_(std::move(budget)), queue_(driver, device, device_name) {}

Display::~Display() {
  const Driver& driver = queue_.driver();
  queue_.free_objects([&] {
    driver.cuStreamSynchronize(queue_.stream());  // copies to the slots
    for (Slot& slot : slots_) {
      free_copy(slot);
      if (slot.locked) driver.cuMemFreeHost(slot.locked);
      if (slot.copied) driver.cuEventDestroy(slot.copied);
      if (slot.read) driver.cuEventDestroy(slot.read);
    }
  });
}

void Display::free_copy(Slot& slot) {
  if (slot.copy == 0) return;
  const Driver& driver = queue_.driver();
  driver.cuEventSynchronize(slot.copied);
  driver.cuStreamSynchronize(queue_.stream());
  driver.cuMemFree(std::exchange(slot.copy, 0));
  budget_->give_back(std::exchange(slot.copy_bytes, 0));
}

bool Display::make_events(Slot& slot) {
  for (Event* const event : {&slot.copied, &slot.read}) {
    if (!*event && !queue_.accepts(queue_.driver().cuEventCreate(event, kEventBlockingSync), kAction)) return false;
  }
  return true;
}

bool Display::grow(Slot& slot, size_t bytes, bool needs_locked) {
  const Driver& driver = queue_.driver();
  if (!make_events(slot)) return false;
  if (slot.copy_bytes < bytes) {
    free_copy(slot);
    if (!budget_->take(bytes)) return false;
    if (!queue_.accepts(driver.cuMemAlloc(&slot.copy, bytes), kAction)) {
      slot.copy = 0;
      budget_->give_back(bytes);
      return false;
    }
    slot.copy_bytes = bytes;
  }
  if (!needs_locked || slot.locked_bytes >= bytes) return true;
  if (slot.locked) {
    driver.cuStreamSynchronize(queue_.stream());  // a copy to it may be queued
    driver.cuMemFreeHost(std::exchange(slot.locked, nullptr));
    slot.locked_bytes = 0;
  }
  if (!queue_.accepts(driver.cuMemHostAlloc(&slot.locked, bytes, 0), kAction)) return false;
  slot.locked_bytes = bytes;
  return true;
}

Display::Slot* Display::take(size_t bytes, bool needs_locked) {
  Slot* slot = nullptr;
  {
    const std::lock_guard lock(mutex_);
    const auto unused = std::find_if(slots_.begin(), slots_.end(), [](const Slot& s) { return !s.in_use; });
    if (unused == slots_.end()) return nullptr;
    unused->in_use = true;
    slot = &*unused;
  }
  if (succeeds(queue_, [&] { return grow(*slot, bytes, needs_locked); })) return slot;
  release(*slot);
  return nullptr;
}

void Display::release(Slot& slot) {
  const std::lock_guard lock(mutex_);
  slot.in_use = false;
}

std::shared_ptr<DeviceImage> Display::copy(Queue& queue, ManagedMemory& memory, const void* pixels, size_t bytes) {
  const bool is_locked = !keeps_on_device_.load();
  Slot* const slot = take(bytes, is_locked);
  if (!slot) return nullptr;
  auto image = std::make_shared<CudaImage>(shared_from_this(), *slot, bytes, is_locked);
  const Driver& driver = queue.driver();
  const Queue::Current current(queue);
  try {
    // Earlier work may still read the copy.
    queue.check(driver.cuStreamWaitEvent(queue.stream(), slot->read, 0), kAction);
    memory.copy(reinterpret_cast<void*>(slot->copy), pixels, bytes);  // NOLINT(performance-no-int-to-ptr)
    queue.check(driver.cuEventRecord(slot->copied, queue.stream()), kAction);
    if (is_locked) copy_to_host(queue, *slot, bytes);
  } catch (...) {
    // The slot may be freed: no work on it may be queued.
    driver.cuStreamSynchronize(queue.stream());
    driver.cuStreamSynchronize(queue_.stream());
    throw;
  }
  return image;
}

void Display::copy_to_host(Queue& queue, const Slot& slot, size_t bytes) {
  const Driver& driver = queue.driver();
  const Stream own = queue_.stream();
  queue.check(driver.cuStreamWaitEvent(own, slot.copied, 0), kAction);
  queue.check(driver.cuMemcpyDtoHAsync(slot.locked, slot.copy, bytes, own), kAction);
  queue.check(driver.cuEventRecord(slot.read, own), kAction);
}

bool Display::draws_window() {
  constexpr unsigned kMost = 16;
  std::array<DeviceNumber, kMost> devices{};
  unsigned count = 0;
  const Result result = queue_.driver().cuGLGetDevices(&count, devices.data(), kMost, kAllGlDevices);
  if (!queue_.accepts(result, kAction)) return false;
  const std::span drawing = std::span(devices).first(std::min(count, kMost));
  return std::find(drawing.begin(), drawing.end(), queue_.device()) != drawing.end();
}

std::unique_ptr<DeviceTexture> Display::share(uint32_t texture, size_t row_bytes, size_t rows) {
  const Driver& driver = queue_.driver();
  Texture registered = nullptr;
  const auto registers = [&] {
    if (!draws_window()) return false;
    return queue_.accepts(driver.cuGraphicsGLRegisterImage(&registered, texture, kTexture2d, kWriteDiscard), kAction);
  };
  const bool works = driver.has_textures() && succeeds(queue_, registers);
  if (!works) return nullptr;
  return std::make_unique<CudaTexture>(shared_from_this(), registered, row_bytes, rows);
}

}  // namespace relume::cuda
