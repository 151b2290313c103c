// Loops with concurrent iterations on TBB's threads. All parallel code uses these functions; passes use frame/launch.h,
// which builds on them.
#pragma once

#include <concepts>
#include <cstddef>

namespace relume {

/// Times of the outermost loops that the current thread started.
struct LoopTimes {
  double elapsed_s = 0;  ///< wall time of the loops, seconds
  double busy_s = 0;     ///< of their iterations and of loops inside, summed over all threads
};

/// Totals of the current thread since it started.
const LoopTimes& loop_times();

namespace detail {

/// Calls run(body, begin, end) for ranges that cover [0, count) exactly once. `each_alone`: ranges of one iteration.
void run_ranges(size_t count, bool each_alone, void (*run)(const void* body, size_t begin, size_t end),
                const void* body);

template <std::integral Index, typename Body>
void run_iterations(Index count, bool each_alone, const Body& body) {
  if (count <= 0) return;
  const auto run = [](const void* b, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) (*static_cast<const Body*>(b))(static_cast<Index>(i));
  };
  run_ranges(static_cast<size_t>(count), each_alone, run, &body);
}

}  // namespace detail

/// Calls body(i) for every i in [0, count) in any order. Returns after the last call; rethrows an exception of a call.
template <std::integral Index, typename Body>
void parallel_for(Index count, const Body& body) {
  detail::run_iterations(count, false, body);
}

/// The same with one task per iteration, for few long iterations of unequal length.
template <std::integral Index, typename Body>
void parallel_tasks(Index count, const Body& body) {
  detail::run_iterations(count, true, body);
}

}  // namespace relume
