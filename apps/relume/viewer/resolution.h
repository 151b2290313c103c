// Scales the resolution so that frames come at a target rate.
#pragma once

#include "core/vec.h"

namespace relume::viewer {

/// Frames are never scaled below this, unless the full size is smaller.
inline constexpr int kMinWidth = 320;
inline constexpr int kMinHeight = 180;

/// Time that the first frame after a rest may take, seconds, and the pixels that it has at least.
inline constexpr double kFirstFrameBudget_s = 0.035;
inline constexpr double kFirstFramePixels = 96 * 54;

/// Holds the time a frame takes near a budget. The scale goes in steps and with hysteresis, because every change of
/// size costs techniques their history. Begins at the smallest size, so that slow machines respond from the first frame
/// on, and goes up from there as far as the budget allows.
class ResolutionControl {
 public:
  /// Size to render at.
  IVec2 size(const IVec2& full) const;

  /// Size of the first frame after a rest: no larger than size(), and small enough for kFirstFrameBudget_s, going by
  /// the time that a pixel of the latest frame took.
  IVec2 first_frame_size(const IVec2& full) const;

  /// Takes note of what a frame of any size cost.
  void measured(double seconds, const IVec2& size);

  /// Takes note of a frame of the present size and adapts the scale. `budget_s`: seconds that a frame may take.
  void frame_done(double seconds, double budget_s, const IVec2& full);

 private:
  int smallest_step(const IVec2& full) const;
  void go_to(int step);

  static constexpr int kFarBelow = 64;  ///< no image has that many steps

  double pixel_s_ = 0;     ///< seconds that a pixel of the latest frame took
  int step_ = kFarBelow;   ///< 0: full size; each step divides the pixels by the square root of two
  int slow_ = 0;           ///< frames in a row that took too long
  int fast_ = 0;           ///< frames in a row that a larger size could have afforded
  double slowest_s_ = 0;   ///< of those
  bool fresh_ = true;      ///< the size is new; its first frame fills caches and says little
  bool searching_ = true;  ///< nothing has been too slow yet
};

}  // namespace relume::viewer
