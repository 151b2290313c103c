// What takes time before the first sample, on standard error.
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

namespace relume::cli {

/// While it lives, shows on a terminal what is loaded and built, as soon as that takes longer than a moment. Elsewhere
/// it shows nothing.
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
