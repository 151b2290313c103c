// Speed of the camera while a key is held.
#pragma once

#include <cstdint>

namespace relume::viewer {

/// Longest duration of a step of a flight, seconds. Slower frames fly less far.
inline constexpr double kLongestStep_s = 0.15;
/// Duration of the first step, when a key goes down.
inline constexpr double kFirstStep_s = 1.0 / 30;

/// Allows one step per displayed frame. The camera is never more than one step ahead of the display, and stops when the
/// keys are released, at any frame time.
class FlyPace {
 public:
  /// Seconds for which the camera moves now; 0 until the previous step is displayed. `held`: a key is down; `shown`:
  /// newest request that the displayed frame follows.
  float step(bool held, uint64_t shown, double now_s);

  /// Sets the request that carries the changes so far.
  void posted(uint64_t version);

 private:
  bool held_ = false;
  bool stepped_ = false;  ///< since the last request
  uint64_t awaited_ = 0;  ///< request of the last step
  double last_s_ = 0;     ///< time of that step, or when the key went down
};

}  // namespace relume::viewer
