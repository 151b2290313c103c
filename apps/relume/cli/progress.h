// Progress of a render, on standard error.
#pragma once

#include <cstdint>
#include <string>

namespace relume::cli {

struct Progress {
  std::string label;  ///< "frame 3 of 10"; empty: none
  uint32_t samples = 0;
  uint32_t samples_wanted = 0;  ///< 0: unknown
  double fraction = 0;          ///< completed, in [0, 1]
  double rays_per_s = 0;
  double error = 0;           ///< estimated relative error; 0 or infinite: not shown
  double remaining_s = 0;     ///< infinite: not shown
  bool shows_samples = true;  ///< false: shows the completed share
};

/// "0:07", "12:34", "1:02:03".
std::string format_duration(double seconds);

/// "frame 3 of 10, 16/64 samples, 12.3 Mrays/s, error 0.031, 0:42 left".
std::string format_progress(const Progress& progress);

/// "[########        ]  " before format_progress(), cut at `columns`.
std::string format_progress_bar(const Progress& progress, int columns);

/// On a terminal, a bar redrawn at most ten times per second; elsewhere a plain line every ten seconds.
class ProgressPrinter {
 public:
  /// `enabled` false: prints nothing.
  explicit ProgressPrinter(bool enabled);
  ~ProgressPrinter();
  ProgressPrinter(const ProgressPrinter&) = delete;
  ProgressPrinter& operator=(const ProgressPrinter&) = delete;

  /// `now_s`: a monotonic clock.
  void show(const Progress& progress, double now_s);
  /// Shows the completed fraction of a stage now.
  void show_stage(const std::string& stage, double fraction);
  /// Removes the bar so that other text can be printed.
  void clear();

 private:
  bool enabled_;
  bool terminal_;
  bool bar_shown_ = false;
  double next_s_ = 0;
  bool started_ = false;
};

}  // namespace relume::cli
