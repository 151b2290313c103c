#include "core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

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

}  // namespace

namespace detail {

void run_ranges(size_t count, bool each_alone, void (*run)(const void* body, size_t begin, size_t end),
                const void* body) {
  using Range = tbb::blocked_range<size_t>;
  LoopOrder order;
  const auto run_range = [&](const Range& range) {
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
