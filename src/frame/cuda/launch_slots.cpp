#include "frame/cuda/launch_slots.h"

#include <utility>

namespace relume::cuda {

LaunchSlots::LaunchSlots(Queue& queue) : queue_(queue) {
  const Queue::Current current(queue_);
  const Driver& driver = queue_.driver();
  try {
    queue_.check(driver.cuMemHostAlloc(&arguments_, kSlots * kArgumentBytes, 0), "allocating page-locked memory");
    for (size_t i = 0; i < kSlots; ++i) {
      slots_[i].argument = static_cast<std::byte*>(arguments_) + i * kArgumentBytes;
      queue_.check(driver.cuEventCreate(&slots_[i].begin, 0), "creating an event");
      queue_.check(driver.cuEventCreate(&slots_[i].end, 0), "creating an event");
    }
  } catch (...) {
    free();
    throw;
  }
}

LaunchSlots::~LaunchSlots() { free(); }

void LaunchSlots::free() {
  const Driver& driver = queue_.driver();
  queue_.free_objects([&] {
    driver.cuStreamSynchronize(queue_.stream());
    for (const LaunchSlot& slot : slots_) {
      for (const Event event : {slot.begin, slot.end}) {
        if (event) driver.cuEventDestroy(event);
      }
    }
    if (arguments_) driver.cuMemFreeHost(arguments_);
  });
}

const LaunchSlot& LaunchSlots::free_slot() {
  wait(kSlots - 1);
  return slots_[(first_ + queued_) % kSlots];
}

void LaunchSlots::add() { ++queued_; }

void LaunchSlots::wait(size_t launches) {
  while (queued_ > launches) {
    queue_.check(queue_.driver().cuEventSynchronize(oldest().end), "waiting for a kernel");
    end_oldest();
  }
}

void LaunchSlots::clear() {
  queued_ = 0;
  times_.clear();
}

void LaunchSlots::end_oldest() {
  float milliseconds = 0;
  queue_.check(queue_.driver().cuEventElapsedTime(&milliseconds, oldest().begin, oldest().end), "timing a kernel");
  times_.push_back(1e-3 * static_cast<double>(milliseconds));
  ++first_;
  --queued_;
}

std::vector<double> LaunchSlots::take_times() {
  while (queued_ > 0) {
    const Result result = queue_.driver().cuEventQuery(oldest().end);
    if (result == Result::not_ready) break;
    queue_.check(result, "asking whether a kernel has ended");
    end_oldest();
  }
  return std::exchange(times_, {});
}

}  // namespace relume::cuda
