// Work that several processes (ranks) share. All of them call the same functions in the same order.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace relume {

/// The ranks that run the tasks of a stage.
enum class TaskRanks {
  all,
  one_per_host,  ///< one of each machine, for times
  first,         ///< the first rank alone, for times that are compared with each other
};

/// Independent tasks of one stage.
struct SharedTasks {
  using Progress = std::function<void(double fraction)>;

  std::vector<size_t> tasks;  ///< of the first rank, dealt out in this order; ignored on others
  TaskRanks ranks = TaskRanks::all;
  /// Runs a task on this rank. Returns its result as bytes; std::nullopt if `stop` was requested first.
  std::function<std::optional<std::string>(size_t task, const std::stop_token& stop, const Progress& progress)> run;
  Progress progress = {};  ///< of all tasks; called on the first rank, on another thread
};

class SharedWork {
 public:
  virtual ~SharedWork() = default;

  virtual int ranks() const = 0;
  /// Whether this rank gathers the results.
  virtual bool is_first() const = 0;
  /// Runs each task on the next free rank. Returns the results in the order of the tasks, without any on other ranks
  /// than the first; std::nullopt if the stage stopped early. Throws the error of a task on the first rank.
  virtual std::optional<std::vector<std::string>> gather(const SharedTasks& tasks, const std::stop_token& stop) = 0;
  /// Returns the bytes of the first rank on all ranks; std::nullopt if the first rank has ended.
  virtual std::optional<std::string> share(std::string bytes) = 0;
};

}  // namespace relume
