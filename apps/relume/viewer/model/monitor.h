// Performance statistics of the viewer: interface rate, rendered frames, and latency of camera changes.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace relume::viewer {

class Monitor {
 public:
  /// Records a frame of the interface.
  void interface_frame(double now_s);
  /// Records a rendered frame.
  void rendered_frame(double now_s);
  /// Records that the `frames`-th frame after a camera change showed it.
  void camera_seen(uint64_t frames);

  double interface_hz() const;  ///< over the last second
  double frames_per_s() const;  ///< over the last three seconds, or between the last two frames if longer
  /// The lowest interface_hz() of any complete second since the first rendered frame; std::nullopt before that.
  std::optional<double> worst_interface_hz() const { return worst_hz_; }
  double longest_gap_s() const { return longest_gap_s_; }  ///< between two frames of the interface
  /// Most rendered frames from a camera change to the first frame that shows it.
  uint64_t camera_latency_frames() const { return latency_; }

  /// Excludes the present gap from the statistics, because other work caused it.
  void interrupt();

  /// Resets the extremes.
  void reset();

 private:
  std::deque<double> shown_s_;
  std::deque<double> rendered_s_;
  std::optional<double> since_s_;
  std::optional<double> worst_hz_;
  double longest_gap_s_ = 0;
  uint64_t latency_ = 0;
};

}  // namespace relume::viewer
