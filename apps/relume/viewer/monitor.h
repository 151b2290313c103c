// Measures how the viewer does: interface rate, rendered frames, and how soon a change of the camera is seen.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace relume::viewer {

class Monitor {
 public:
  /// A frame of the interface was shown.
  void interface_frame(double now_s);
  /// A rendered frame arrived.
  void rendered_frame(double now_s);
  /// A change of the camera was seen in the `frames`-th frame after it.
  void camera_seen(uint64_t frames);

  double interface_hz() const;  ///< over the last second
  double frames_per_s() const;  ///< over the last three seconds, or the last two frames if those are longer apart
  /// The lowest interface_hz() of any complete second since the first rendered frame; nothing before that.
  std::optional<double> worst_interface_hz() const { return worst_hz_; }
  double longest_gap_s() const { return longest_gap_s_; }  ///< between two frames of the interface
  /// Rendered frames from a change of the camera to the first that shows it, at most.
  uint64_t camera_latency_frames() const { return latency_; }

  /// What comes next is not to be compared with what was before: something else took the time.
  void interrupt();

  /// Forgets the extremes so far.
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
