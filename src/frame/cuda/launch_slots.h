// Room for the launches in a device's queue.
#pragma once

#include <array>
#include <cstddef>
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

  std::array<Event*, 3> events() { return {&moves, &begin, &end}; }
};

/// A ring of slots. One thread uses it, with the queue's context current.
class LaunchSlots {
 public:
  /// Most launches in the queue.
  static constexpr size_t kSlots = 64;

  /// The queue must outlive the slots. Throws as Queue::check(); so do all other functions except clear().
  explicit LaunchSlots(Queue& queue);
  ~LaunchSlots();
  LaunchSlots(const LaunchSlots&) = delete;
  LaunchSlots& operator=(const LaunchSlots&) = delete;

  /// A slot for the next launch. Waits for the oldest launch if none is free.
  LaunchSlot& free_slot();
  /// Begins the use of free_slot(), whose events are now in the queue. `name`: of the launch, for messages.
  void add(std::string_view name);
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
