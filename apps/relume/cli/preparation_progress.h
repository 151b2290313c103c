// Progress of the work before the first sample, on standard error.
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

namespace relume::cli {

/// During its lifetime, shows on a terminal the current loading or building step once it takes longer than
/// `patience_s`. Shows nothing elsewhere.
class PreparationProgress {
 public:
  static constexpr double kPatience_s = 1;

  /// `enabled` false: shows nothing.
  explicit PreparationProgress(bool enabled, double patience_s = kPatience_s);
  ~PreparationProgress();
  PreparationProgress(const PreparationProgress&) = delete;
  PreparationProgress& operator=(const PreparationProgress&) = delete;

 private:
  void show(const std::stop_token& stop, double patience_s);

  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

}  // namespace relume::cli
