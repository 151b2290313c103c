// How far a held key moves the camera.
#pragma once

#include <cstdint>

namespace relume::viewer {

/// Longest time that one step of a flight stands for, seconds: what slow frames do not show is not flown.
inline constexpr double kLongestStep_s = 0.15;
/// The same of the first step, when a key goes down.
inline constexpr double kFirstStep_s = 1.0 / 30;

/// Gives one step for each frame that was shown, so that the camera never gets further than a step beyond what the user
/// has seen, and stops where the keys are released, however long frames take.
class FlyPace {
 public:
  /// Seconds for which the camera moves now; 0 while the step before has not been shown. `held`: a key is down;
  /// `shown`: newest request that the frame on display follows.
  float step(bool held, uint64_t shown, double now_s);

  /// Names the request that carries what has been changed by now.
  void posted(uint64_t version);

 private:
  bool held_ = false;
  bool stepped_ = false;  ///< since the last request
  uint64_t awaited_ = 0;  ///< request of the last step
  double last_s_ = 0;     ///< when that was, or the key went down
};

}  // namespace relume::viewer
