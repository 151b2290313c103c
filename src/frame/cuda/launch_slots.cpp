#include "frame/cuda/launch_slots.h"

#include <cassert>
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

LaunchSlot& LaunchSlots::free_slot(size_t skipped) {
  assert(skipped < kSlots);
  wait(kSlots - 1 - skipped);
  return slots_[(launched() + skipped) % kSlots];
}

void LaunchSlots::take_slot(std::string_view name) {
  queue_.launched(name);
  ++queued_;
}

void LaunchSlots::add(std::string_view name) {
  LaunchSlot& slot = free_slot();
  slot.timed_from = slot.begin;
  slot.timed_to = slot.reached = slot.end;
  take_slot(name);
}

void LaunchSlots::add_graph(std::span<const std::string_view> names, std::span<const Event> ends) {
  assert(ends.size() + 1 == names.size());
  const Event reached = free_slot(names.size() - 1).end;
  Event from = free_slot().begin;
  for (size_t i = 0; i < names.size(); ++i) {
    LaunchSlot& slot = free_slot();
    if (i > 0) slot.has_moves = false;
    slot.timed_from = from;
    slot.timed_to = i < ends.size() ? ends[i] : reached;
    slot.reached = reached;
    from = slot.timed_to;
    take_slot(names[i]);
  }
}

void LaunchSlots::add_dropped(size_t launches) {
  wait(0);
  times_.insert(times_.end(), launches, 0.0);
}

void LaunchSlots::wait_for_oldest() {
  queue_.check(queue_.driver().cuEventSynchronize(oldest().reached), "waiting for a kernel");
  end_oldest();
}

void LaunchSlots::wait_for(size_t launches) {
  while (queued_ > 0 && first_ < launches) wait_for_oldest();
}

void LaunchSlots::wait(size_t launches) {
  while (queued_ > launches) wait_for_oldest();
}

void LaunchSlots::clear() {
  first_ += queued_;
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
  times_.push_back(seconds_between(slot.timed_from, slot.timed_to));
  if (slot.has_moves) move_s_ += seconds_between(slot.moves, slot.begin);
  queue_.oldest_ended();
  ++first_;
  --queued_;
}

std::vector<double> LaunchSlots::take_times() {
  while (queued_ > 0) {
    const Result result = queue_.driver().cuEventQuery(oldest().reached);
    if (result == Result::not_ready) break;
    queue_.check(result, "asking whether a kernel has ended");
    end_oldest();
  }
  return std::exchange(times_, {});
}

}  // namespace relume::cuda
