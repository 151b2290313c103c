// Adapts frames to what a viewer's link carries, as its acknowledgements show.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace relume::serve {

/// Compression of frames.
struct FrameLevel {
  int quality = 80;  ///< of JPEG, 1 to 100
  int divisor = 1;   ///< of width and height
};

/// From the best to the smallest.
inline constexpr std::array<FrameLevel, 8> kLevels = {
    {{92, 1}, {82, 1}, {68, 1}, {50, 1}, {60, 2}, {40, 2}, {45, 4}, {25, 4}}};

/// Permits frames while few are under way, and chooses their level. Delays beyond the link's shortest, and frames that
/// the link had no room for, lower the level; a time without either raises it.
class LinkControl {
 public:
  /// Whether a frame that is ready may be sent. Counts those that may not, unless the one before is recent.
  bool offer(uint64_t view, double now_s);
  void sent(uint32_t frame, double now_s);
  /// The viewer shows this frame, and so has those before. Ignores unknown frames.
  void acknowledged(uint32_t frame, double now_s);

  /// Index in kLevels.
  int level() const { return level_; }
  /// Frames that may be under way: enough to fill a link of this delay with 30 frames per second.
  size_t window() const;
  /// Shortest delay from sending to acknowledgement of the last seconds, seconds; 0 before the first.
  double base_delay_s() const;
  double delay_s() const { return delay_s_; }  ///< of the latest frame

 private:
  void judge(double queue_s, double now_s);
  void lower(int by, double now_s);
  void raise(double now_s);
  void start_period(double now_s);

  struct Sent {
    uint32_t frame;
    double at_s;
  };
  std::deque<Sent> under_way_;
  int level_ = 1;
  double delay_s_ = 0;
  std::array<double, 2> shortest_s_{};  ///< of this period of kBasePeriod_s and the one before; 0: none
  double base_since_s_ = 0;
  double period_since_s_ = 0;  ///< in which frames are counted
  int offered_ = 0;
  int missed_ = 0;
  uint64_t missed_view_ = 0;  ///< counted last
  double changed_s_ = 0;      ///< when the level last changed
  double good_since_s_ = 0;   ///< since when the link has had room
  double raise_after_s_ = 2;  ///< of a good link; grows if raising the level fails
  double raised_s_ = -1e9;
  bool raise_failed_ = false;  ///< whether the last raise did
};

}  // namespace relume::serve
