// Two threads as ranks that share work.
#pragma once

#include <atomic>
#include <barrier>
#include <cstddef>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "compare/shared_work.h"

namespace relume {

/// What two ranks have in common.
struct RankRoom {
  std::barrier<> barrier{2};
  std::string bytes;
  std::vector<size_t> tasks;
  std::vector<std::string> results;
  std::atomic<size_t> next = 0;
};

/// A rank of a RankRoom. The second one runs the first task of each stage, unless that is the first rank's alone.
class ThreadRank : public SharedWork {
 public:
  ThreadRank(RankRoom& room, bool is_first) : room_(room), is_first_(is_first) {}

  int ranks() const override { return 2; }
  bool is_first() const override { return is_first_; }
  std::optional<std::vector<std::string>> gather(const SharedTasks& work, const std::stop_token& stop) override {
    if (is_first_) {
      room_.tasks = work.tasks;
      room_.results.assign(work.tasks.size(), {});
      room_.next = 0;
    }
    room_.barrier.arrive_and_wait();
    const bool for_first = work.ranks == TaskRanks::first;
    if (is_first_ == for_first) run_next(work, stop);
    room_.barrier.arrive_and_wait();
    if (work.ranks == TaskRanks::all || is_first_ == for_first) {
      while (run_next(work, stop)) continue;
    }
    room_.barrier.arrive_and_wait();
    return is_first_ ? room_.results : std::vector<std::string>();
  }
  std::optional<std::string> share(std::string bytes) override {
    if (is_first_) room_.bytes = std::move(bytes);
    room_.barrier.arrive_and_wait();
    std::string shared = room_.bytes;
    room_.barrier.arrive_and_wait();
    return shared;
  }

 private:
  bool run_next(const SharedTasks& work, const std::stop_token& stop) {
    const size_t position = room_.next++;
    if (position >= room_.tasks.size()) return false;
    room_.results[position] = work.run(room_.tasks[position], stop, [](double) {}).value();
    return true;
  }

  RankRoom& room_;
  bool is_first_;
};

}  // namespace relume
