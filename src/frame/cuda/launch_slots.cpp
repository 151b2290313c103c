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
      for (Event* const event : slots_[i].events())
        queue_.check(driver.cuEventCreate(event, kEventBlockingSync), "creating an event");
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
    for (LaunchSlot& slot : slots_) {
      for (Event* const event : slot.events()) {
        if (*event) driver.cuEventDestroy(*event);
      }
    }
    if (arguments_) driver.cuMemFreeHost(arguments_);
  });
}

LaunchSlot& LaunchSlots::free_slot() {
  wait(kSlots - 1);
  return slots_[(first_ + queued_) % kSlots];
}

void LaunchSlots::add(std::string_view name) {
  queue_.launched(name);
  ++queued_;
}

void LaunchSlots::wait(size_t launches) {
  while (queued_ > launches) {
    queue_.check(queue_.driver().cuEventSynchronize(oldest().end), "waiting for a kernel");
    end_oldest();
  }
}

void LaunchSlots::clear() {
  queued_ = 0;
  times_.clear();
  move_s_ = 0;
  queue_.all_ended();
}

double LaunchSlots::seconds_between(Event begin, Event end) {
  float milliseconds = 0;
  queue_.check(queue_.driver().cuEventElapsedTime(&milliseconds, begin, end), "timing a kernel");
  return 1e-3 * static_cast<double>(milliseconds);
}

void LaunchSlots::end_oldest() {
  const LaunchSlot& slot = oldest();
  times_.push_back(seconds_between(slot.begin, slot.end));
  if (slot.has_moves) move_s_ += seconds_between(slot.moves, slot.begin);
  queue_.oldest_ended();
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
