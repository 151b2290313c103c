// Independent tasks of a command, dealt out to ranks on demand.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "compare/shared_work.h"
#include "ranks/link.h"
#include "ranks/task_dealer.h"

namespace relume::ranks {

/// Each rank has one, and calls the same functions in the same order. Without a launcher, one process runs all tasks in
/// order.
class TaskPool : public SharedWork {
 public:
  /// `remedy`: what to do after a rank is lost, for its message. Throws Error if ranks were started but MPI is missing.
  explicit TaskPool(std::string remedy);
  /// Ends all ranks with kExitFailed, unless end() was called.
  ~TaskPool() override;
  TaskPool(const TaskPool&) = delete;
  TaskPool& operator=(const TaskPool&) = delete;

  int ranks() const override { return link_->size(); }
  bool is_first() const override { return link_->rank() == 0; }
  std::optional<std::vector<std::string>> gather(const SharedTasks& work, const std::stop_token& stop) override;
  std::optional<std::string> share(std::string bytes) override;

  /// Runs this rank's part of a command, which returns its exit code, and ends all ranks. Returns the exit code of the
  /// first rank, which also prints an error of its part; errors of other ranks become those of its gather().
  int run_and_end(const std::function<int()>& part);
  /// Waits for all ranks, and ends MPI. Returns the exit code that the first rank gave.
  int end(int exit_code);

 private:
  /// A stage on the first rank.
  struct Stage {
    TaskDealer dealer;
    std::vector<std::string> results;
    std::string problem = {};  ///< error of a task; empty: none
    int problem_rank = 0;
    bool stopped = false;    ///< whether a task ended early
    bool cancelled = false;  ///< whether ranks were told to end their tasks
  };

  void serve(const SharedTasks& work, const std::stop_token& stop, Stage& stage);
  void take(const Message& message, Stage& stage);
  void check_ranks() const;
  bool work_until_finish(const SharedTasks& work, const std::stop_token& stop);
  void run_task(const Message& deal, const SharedTasks& work, const std::stop_token& stop);
  Message next_message();
  int end_with_error(const std::string& sentence, int exit_code);
  std::string name_of(int rank) const;

  std::unique_ptr<RankLink> link_;
  std::string remedy_;
  std::vector<std::string> hosts_;      ///< by rank, as far as they are known
  std::exception_ptr failure_;          ///< of this rank's task
  std::optional<int> first_has_ended_;  ///< its exit code
  bool ended_ = false;
};

}  // namespace relume::ranks
