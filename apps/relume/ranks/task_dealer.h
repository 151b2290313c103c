// Which rank runs which task of a stage. Without messages, so that it can be tested.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "compare/shared_work.h"

namespace relume::ranks {

class TaskDealer {
 public:
  /// `workers`: the ranks that get tasks. With TaskRanks::one_per_host, the first of each machine that waits.
  TaskDealer(size_t tasks, int ranks, TaskRanks workers)
      : tasks_(tasks), workers_(workers), ranks_(static_cast<size_t>(ranks)) {}

  /// A rank waits for a task.
  void wait(int rank, const std::string& host);
  /// A rank takes no task any more.
  void leave(int rank) { ranks_[static_cast<size_t>(rank)].state = State::gone; }
  /// The completed fraction of a rank's task, in [0, 1].
  void note_progress(int rank, double fraction) { ranks_[static_cast<size_t>(rank)].fraction = fraction; }
  /// A result has arrived.
  void note_result() { ++results_; }
  /// Deals no further task.
  void cancel() { cancelled_ = true; }

  struct Deal {
    int rank = 0;
    size_t task = 0;  ///< position in the stage
  };
  /// Tasks for the ranks that wait. These then work. Unless all ranks get tasks, deals none before each rank has waited
  /// or left: a rank that still computes would change the times of others.
  std::vector<Deal> deal();

  /// Whether no rank works and no task will be dealt.
  bool is_over() const;
  /// Whether all results have arrived.
  bool is_complete() const { return results_ == tasks_; }
  /// Completed fraction of all tasks.
  double fraction() const;

 private:
  enum class State { works, waits, gone };  ///< a rank that has not reported so far counts as working
  struct Rank {
    State state = State::works;
    std::string host = {};
    double fraction = 0;
  };
  bool have_all_reported() const;
  bool gets_tasks(size_t rank) const;
  bool is_first_of_host(size_t rank) const;

  size_t tasks_;
  TaskRanks workers_;
  std::vector<Rank> ranks_;
  std::vector<size_t> arrivals_ = {};  ///< ranks in the order of their first wait()
  size_t next_ = 0;
  size_t results_ = 0;
  bool cancelled_ = false;
};

}  // namespace relume::ranks
