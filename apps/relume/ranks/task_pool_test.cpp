#include "ranks/task_pool.h"

#include <vector>

#include <gtest/gtest.h>

namespace relume::ranks {
namespace {

TEST(TaskPool, DealsAllTasksToOneProcess) {
  TaskPool pool(3);
  std::vector<size_t> tasks;
  while (const auto task = pool.next()) tasks.push_back(*task);
  EXPECT_EQ(tasks, (std::vector<size_t>{0, 1, 2}));
  pool.failed("second");
  EXPECT_EQ(pool.finish(), std::vector<std::string>{"second"});
}

TEST(TaskPool, CanEndEarly) {
  TaskPool pool(3);
  EXPECT_EQ(pool.next(), 0u);
}

}  // namespace
}  // namespace relume::ranks
