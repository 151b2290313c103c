#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <thread>
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

TEST(Parallel, LoopsAreTimed) {
  const auto wait = [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(5)); };
  const LoopTimes before = loop_times();
  parallel_tasks(8, wait);
  const LoopTimes flat = loop_times();
  EXPECT_GE(flat.busy_s - before.busy_s, 0.04);
  EXPECT_GE(flat.elapsed_s - before.elapsed_s, 0.005);
  parallel_tasks(2, [&](int) { parallel_tasks(4, wait); });
  EXPECT_GE(loop_times().busy_s - flat.busy_s, 0.04);
  const LoopTimes nested = loop_times();
  parallel_tasks(1, [&](int) { parallel_tasks(1, wait); });  // the inner loop is not counted twice
  const double elapsed_s = loop_times().elapsed_s - nested.elapsed_s;
  EXPECT_GE(elapsed_s, 0.005);
  EXPECT_LE(loop_times().busy_s - nested.busy_s, elapsed_s);
}

}  // namespace
}  // namespace relume
