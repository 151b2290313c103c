// Runs group kernels (frame/group.h) with the calls of each() in random order. A kernel whose calls depend on each
// other then gives other results than on one thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numeric>
#include <random>
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

/// Runs a width × height grid of groups. The shared memory of each begins with bytes of 0xff: NaN as floats.
template <typename Kernel>
void run_shuffled(const Kernel& kernel, uint32_t width, uint32_t height, uint32_t seed) {
  using Shared = typename Kernel::Shared;
  const ShuffledGroup group(seed);
  const auto shared = std::make_unique<Shared>();
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      std::memset(static_cast<void*>(shared.get()), 0xff, sizeof(Shared));
      kernel(group, *shared, x, y);
    }
  }
}

}  // namespace relume::testing
