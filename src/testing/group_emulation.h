// Runs group kernels (frame/group.h) as a device might: with the calls of each() in random order, or on threads. A
// kernel that breaks the rules of groups then gives other results than on one thread, or ThreadSanitizer reports it.
#pragma once

#include <algorithm>
#include <barrier>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numeric>
#include <random>
#include <thread>
#include <vector>

namespace relume::testing {

/// Calls f(0) … f(n − 1) in a new random order each time.
class ShuffledGroup {
 public:
  explicit ShuffledGroup(uint32_t seed) : generator_(seed) {}

  template <typename Function>
  void each(uint32_t n, const Function& f) const {
    std::vector<uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), generator_);
    for (const uint32_t i : order) f(i);
  }

 private:
  mutable std::mt19937 generator_;
};

/// One thread of a group. Calls are distributed over the threads.
class ThreadedGroup {
 public:
  ThreadedGroup(std::barrier<>& barrier, uint32_t thread, uint32_t threads)
      : barrier_(barrier), thread_(thread), threads_(threads) {}

  template <typename Function>
  void each(uint32_t n, const Function& f) const {
    barrier_.arrive_and_wait();
    for (uint32_t i = thread_; i < n; i += threads_) f(i);
    barrier_.arrive_and_wait();
  }

 private:
  std::barrier<>& barrier_;
  uint32_t thread_;
  uint32_t threads_;
};

/// Fills shared memory with 0xff bytes, which are NaN as floats, so that reads before writes change the result.
template <typename Shared>
void poison(Shared& shared) {
  std::memset(static_cast<void*>(&shared), 0xff, sizeof(Shared));
}

/// Runs a width × height grid of groups, each by a ShuffledGroup. Shared memory is poisoned first.
template <typename Kernel>
void run_shuffled(const Kernel& kernel, uint32_t width, uint32_t height, uint32_t seed) {
  const ShuffledGroup group(seed);
  const auto shared = std::make_unique<typename Kernel::Shared>();
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      poison(*shared);
      kernel(group, *shared, x, y);
    }
  }
}

/// Runs a width × height grid of groups, each on several threads. Shared memory is poisoned first.
template <typename Kernel>
void run_threaded(const Kernel& kernel, uint32_t width, uint32_t height) {
  constexpr uint32_t kThreads = 3;  // fewer than on a device; an odd number divides most sizes unevenly
  std::barrier<> barrier(kThreads);
  const auto shared = std::make_unique<typename Kernel::Shared>();
  const auto run = [&](uint32_t thread) {
    const ThreadedGroup group(barrier, thread, kThreads);
    for (uint32_t i = 0; i < width * height; ++i) {
      if (thread == 0) poison(*shared);
      barrier.arrive_and_wait();
      kernel(group, *shared, i % width, i / width);
      barrier.arrive_and_wait();
    }
  };
  std::vector<std::jthread> others;
  for (uint32_t thread = 1; thread < kThreads; ++thread) others.emplace_back(run, thread);
  run(0);
}

}  // namespace relume::testing
