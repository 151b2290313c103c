// Room for the launches in a device's queue.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "frame/cuda/queue.h"

namespace relume::cuda {

/// Size of an argument: the limit of KernelArgument, bytes.
inline constexpr size_t kArgumentBytes = 4096;

/// Objects of a queued launch, until it has ended.
struct LaunchSlot {
  Event moves = nullptr;  ///< begin of the moves of memory before the launch
  Event begin = nullptr;
  Event end = nullptr;
  /// kArgumentBytes that the device copies. Page-locked, so that the copy is queued, too.
  std::byte* argument = nullptr;
  bool has_moves = false;  ///< whether `moves` is in the queue

  // Of the queued launch. A graph has events between its launches, and the host knows only the end of the last one.
  Event timed_from = nullptr;
  Event timed_to = nullptr;
  Event reached = nullptr;  ///< reached once the launch has ended

  std::array<Event*, 3> events() { return {&moves, &begin, &end}; }
};

/// A ring of slots. One thread at a time uses it, with the queue's context current.
class LaunchSlots {
 public:
  /// Most launches in the queue.
  static constexpr size_t kSlots = 64;

  /// The queue must outlive the slots. Throws as Queue::check(); so do all other functions except clear().
  explicit LaunchSlots(Queue& queue);
  ~LaunchSlots();
  LaunchSlots(const LaunchSlots&) = delete;
  LaunchSlots& operator=(const LaunchSlots&) = delete;

  /// The slot of the next launch, or of the one that follows `skipped` others. Waits for the oldest launches if it is
  /// not free.
  LaunchSlot& free_slot(size_t skipped = 0);
  /// Begins the use of free_slot(), whose events are now in the queue. `name`: of the launch, for messages.
  void add(std::string_view name);
  /// The same for the launches of a graph, between the begin of the first free slot and the end of the last one.
  /// `ends`: events after all launches but the last.
  void add_graph(std::span<const std::string_view> names, std::span<const Event> ends);
  /// Adds launches that were not given to the driver after an error. They take no time. Waits for the others first.
  void add_dropped(size_t launches);
  /// Number of launches so far.
  size_t launched() const { return first_ + queued_; }
  /// Waits until the first `launches` launches of all have ended.
  void wait_for(size_t launches);
  /// Waits until at most `launches` launches have not ended.
  void wait(size_t launches);
  /// Forgets all launches, which have ended or failed, and their times.
  void clear();

  /// Times of the launches that have ended since the last call, seconds.
  std::vector<double> take_times();
  /// Time of the moves before them, seconds.
  double take_move_time() { return std::exchange(move_s_, 0); }

 private:
  const LaunchSlot& oldest() const { return slots_[first_ % kSlots]; }
  void wait_for_oldest();
  /// Begins the use of the next slot, whose events are chosen.
  void take_slot(std::string_view name);
  /// Frees the slot of the oldest launch, which has ended.
  void end_oldest();
  double seconds_between(Event begin, Event end);
  void free();

  Queue& queue_;
  std::array<LaunchSlot, kSlots> slots_{};
  void* arguments_ = nullptr;
  size_t first_ = 0;   ///< number of the oldest launch in the queue
  size_t queued_ = 0;  ///< launches in the queue
  std::vector<double> times_;
  double move_s_ = 0;
};

}  // namespace relume::cuda
