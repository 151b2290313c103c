#include "ranks/task_pool.h"

#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace relume::ranks {
namespace {

TEST(TaskPool, OneProcessRunsAllTasksInOrder) {
  TaskPool pool("");
  std::vector<size_t> tasks;
  const auto run = [&](size_t task, const std::stop_token&, const SharedTasks::Progress&) {
    tasks.push_back(task);
    return std::optional(std::to_string(task));
  };
  for (int stage = 0; stage < 2; ++stage) {
    tasks.clear();
    const auto results = pool.gather({.tasks = {3, 1, 4}, .run = run}, {});
    ASSERT_TRUE(results);
    EXPECT_EQ(*results, (std::vector<std::string>{"3", "1", "4"}));
    EXPECT_EQ(tasks, (std::vector<size_t>{3, 1, 4}));
  }
  EXPECT_EQ(pool.gather({.tasks = {}, .run = run}, {}), std::vector<std::string>());
  EXPECT_EQ(pool.share("bytes"), "bytes");
  EXPECT_EQ(pool.end(7), 7);
}

TEST(TaskPool, AStoppedTaskEndsTheStage) {
  TaskPool pool("");
  int runs = 0;
  std::stop_source source;
  const auto run = [&](size_t, const std::stop_token& stop, const SharedTasks::Progress&) {
    ++runs;
    source.request_stop();
    return stop.stop_requested() ? std::nullopt : std::optional(std::string());
  };
  EXPECT_FALSE(pool.gather({.tasks = {0, 1, 2}, .run = run}, source.get_token()));
  EXPECT_EQ(runs, 1);
}

TEST(TaskPool, AnErrorOfATaskKeepsItsType) {
  TaskPool pool("");
  const auto run = [](size_t task, const std::stop_token&, const SharedTasks::Progress&) -> std::optional<std::string> {
    if (task == 1) throw std::out_of_range("the second task fails");
    return "";
  };
  EXPECT_THROW(pool.gather({.tasks = {0, 1, 2}, .run = run}, {}), std::out_of_range);
}

TEST(TaskPool, CanEndEarly) { const TaskPool pool(""); }

}  // namespace
}  // namespace relume::ranks
