#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace relume {
namespace {

TEST(Parallel, EveryIterationRunsOnce) {
  for (const uint32_t count : {0u, 1u, 7u, 100000u}) {
    std::vector<int> runs(count, 0);
    parallel_for(count, [&](uint32_t i) { ++runs[i]; });
    EXPECT_EQ(runs, std::vector<int>(count, 1));
    parallel_tasks(count, [&](uint32_t i) { ++runs[i]; });
    EXPECT_EQ(runs, std::vector<int>(count, 2));
  }
}

TEST(Parallel, NegativeCountsRunNothing) {
  parallel_for(-1, [](int) { FAIL(); });
  parallel_tasks(-1, [](int) { FAIL(); });
}

TEST(Parallel, ExceptionsPropagate) {
  const auto fail_at_7 = [](int i) {
    if (i == 7) throw std::runtime_error("seven");
  };
  EXPECT_THROW(parallel_for(100, fail_at_7), std::runtime_error);
  EXPECT_THROW(parallel_tasks(100, fail_at_7), std::runtime_error);
}

TEST(Parallel, LoopsMayBeNested) {
  std::atomic<int> runs = 0;
  parallel_tasks(8, [&](int) { parallel_for(100, [&](int) { ++runs; }); });
  EXPECT_EQ(runs, 800);
}

}  // namespace
}  // namespace relume
