// Independent tasks of a command, dealt out to ranks on demand.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ranks/link.h"

namespace relume::ranks {

/// Each rank has one, for the same number of tasks. Without a launcher, one process runs all tasks in order.
class TaskPool {
 public:
  /// Throws Error if ranks were started but MPI is missing.
  explicit TaskPool(size_t tasks);
  /// Calls finish() if that was not done; no further task is dealt then.
  ~TaskPool();
  TaskPool(const TaskPool&) = delete;
  TaskPool& operator=(const TaskPool&) = delete;

  int rank() const { return link_->rank(); }
  /// Index of the next task for this rank; std::nullopt: none is left.
  std::optional<size_t> next();
  /// Notes that a task of this rank failed.
  void failed(const std::string& name);
  /// Waits for all ranks, and ends MPI. Returns the failed tasks of all ranks on rank 0, and none on others.
  std::vector<std::string> finish();

 private:
  void serve(size_t tasks);
  void join();

  std::unique_ptr<RankLink> link_;
  std::atomic<bool> stops_ = false;  ///< whether no further task is dealt
  std::vector<std::string> failed_;  ///< of the server
  bool finished_ = false;
  std::thread server_;  ///< on rank 0
};

}  // namespace relume::ranks
