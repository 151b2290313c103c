#include "core/parallel.h"

#include <atomic>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/clock.h"

#if defined(RELUME_THREAD_SANITIZER)
#include <sanitizer/tsan_interface.h>
#endif

namespace relume {
namespace {

/// Tells ThreadSanitizer, which cannot observe TBB, that a loop's tasks follow the code before the loop and precede the
/// code after it. This file is built without ThreadSanitizer (CMakeLists.txt).
class LoopOrder {
 public:
#if defined(RELUME_THREAD_SANITIZER)
  LoopOrder() { __tsan_release(&begun_); }
  ~LoopOrder() { __tsan_acquire(&ended_); }
  void task_begins() { __tsan_acquire(&begun_); }
  void task_ends() { __tsan_release(&ended_); }

 private:
  char begun_ = 0;
  char ended_ = 0;
#else
  void task_begins() {}
  void task_ends() {}
#endif
};

thread_local LoopTimes times_of_thread;

/// Sum of the outer loop whose iteration this thread runs; nullptr: none.
thread_local std::atomic<double>* current_busy_s = nullptr;

/// Adds the time of a range to the sum of the outer loop. While a thread waits in a range, it may run another range,
/// whose time is already part of the outer one.
class BusyRange {
 public:
  explicit BusyRange(std::atomic<double>& busy_s) : is_outer_(current_busy_s == nullptr) {
    if (!is_outer_) return;
    current_busy_s = &busy_s;
    start_s_ = now_s();
  }
  ~BusyRange() {
    if (!is_outer_) return;
    current_busy_s->fetch_add(now_s() - start_s_, std::memory_order_relaxed);
    current_busy_s = nullptr;
  }
  BusyRange(const BusyRange&) = delete;
  BusyRange& operator=(const BusyRange&) = delete;

 private:
  bool is_outer_;
  double start_s_ = 0;
};

/// Adds the times of an outer loop to those of the thread that began it.
class TimedLoop {
 public:
  TimedLoop() : busy_s_(current_busy_s ? *current_busy_s : own_busy_s_) {
    if (is_outer()) start_s_ = now_s();
  }
  ~TimedLoop() {
    if (!is_outer()) return;
    times_of_thread.elapsed_s += now_s() - start_s_;
    times_of_thread.busy_s += own_busy_s_.load();
  }
  TimedLoop(const TimedLoop&) = delete;
  TimedLoop& operator=(const TimedLoop&) = delete;

  std::atomic<double>& busy_s() { return busy_s_; }

 private:
  bool is_outer() const { return &busy_s_ == &own_busy_s_; }

  std::atomic<double> own_busy_s_{0};
  std::atomic<double>& busy_s_;
  double start_s_ = 0;
};

}  // namespace

const LoopTimes& loop_times() { return times_of_thread; }

namespace detail {

void run_ranges(size_t count, bool each_alone, void (*run)(const void* body, size_t begin, size_t end),
                const void* body) {
  using Range = tbb::blocked_range<size_t>;
  LoopOrder order;
  TimedLoop loop;
  const auto run_range = [&](const Range& range) {
    const BusyRange busy(loop.busy_s());
    order.task_begins();
    run(body, range.begin(), range.end());
    order.task_ends();
  };
  if (each_alone) {
    tbb::parallel_for(Range(0, count), run_range, tbb::simple_partitioner());
  } else {
    tbb::parallel_for(Range(0, count), run_range);
  }
}

}  // namespace detail
}  // namespace relume
