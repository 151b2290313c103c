// Scales the resolution to a target frame rate.
#pragma once

#include "core/vec.h"

namespace relume::viewer {

/// Minimum size of frames, unless the full size is smaller.
inline constexpr int kMinWidth = 96;
inline constexpr int kMinHeight = 54;

/// Time limit of the first frame after a rest, seconds, at the cost per pixel of a full frame. Small frames cost more.
inline constexpr double kFirstFrameBudget_s = 0.028;

/// Keeps the frame time near a budget. The scale changes in steps with hysteresis, because a change of size discards
/// techniques' history. Starts at the smallest size, so that slow machines respond from the first frame, and grows as
/// the budget allows.
class ResolutionControl {
 public:
  /// Allows temporal upscaling, which is used before the size is lowered.
  void allow_upscaling(bool allowed) { may_upscale_ = allowed; }

  /// Render size.
  IVec2 size(const IVec2& full) const;

  /// Edge of the blocks of pixels with one path per frame (UpscalingSettings): 1 or 2.
  int upscale() const { return may_upscale_ && step_ >= kUpscaleSteps ? 2 : 1; }

  /// Size of the first frame after a rest: at most size(), and within kFirstFrameBudget_s at the latest frame's time
  /// per pixel, but at least the minimum size. Upscaled frames of full size keep it, and with it their history.
  IVec2 first_frame_size(const IVec2& full) const;

  /// Records the cost of a frame of any size.
  void measured(double seconds, const IVec2& size);

  /// Records a frame of the present size and adapts the scale. `budget_s`: seconds per frame.
  void frame_done(double seconds, double budget_s, const IVec2& full);

 private:
  /// Steps of the size below full size.
  int size_step() const { return upscale() > 1 ? step_ - kUpscaleSteps : step_; }
  int smallest_step(const IVec2& full) const;
  void go_to(int step);

  /// An upscaled frame of full size takes about half the time of a normal one, as a frame two steps smaller does. It is
  /// step 2, and step 1 is skipped.
  static constexpr int kUpscaleSteps = 2;

  static constexpr int kFarBelow = 64;  ///< more steps than any image has

  double pixel_s_ = 0;  ///< seconds per pixel of the latest frame
  bool may_upscale_ = false;
  int step_ = kFarBelow;   ///< 0: full size; each step divides the time of a frame by about the square root of two
  int slow_ = 0;           ///< consecutive frames above the budget
  int fast_ = 0;           ///< consecutive frames with time for a larger size
  double slowest_s_ = 0;   ///< slowest of those
  bool fresh_ = true;      ///< whether the size is new: its first frame fills caches and is not representative
  bool searching_ = true;  ///< whether no frame has been too slow so far
};

}  // namespace relume::viewer
