// How many frames a technique needs after a change of the scene or the camera until its error has settled.
#pragma once

#include <cstddef>
#include <string>

#include "experiments/measure/adaptation.h"
#include "experiments/measure/ratio.h"

namespace relume {

inline constexpr double kSettled = 1.1;         ///< error over the settled one
inline constexpr size_t kFramesOfSettling = 4;  ///< frames over which errors are averaged

/// Errors of frames after a change, in runs with different seeds.
struct Settling {
  Adaptation after;
  /// Settled errors, frame by frame: those of sessions that saw no change, only the state after it. Needed for images
  /// that keep improving. No runs: the settled error is the mean of the last quarter of `after`.
  Adaptation fresh = {};

  bool has_fresh() const { return !fresh.runs.empty(); }
};

/// Mean error of kFramesOfSettling frames from `begin` on over the settled one. Requires that many frames.
Ratio over_settled(const Settling& settling, size_t begin);

/// Number of the first frame, from 1 on, from which the error is at most kSettled times the settled one; 0: none, or
/// the settled error is below the reference's noise.
size_t frames_until_settled(const Settling& settling);

/// "from frame 5 on", or "not within 48 frames".
std::string settled_text(const Settling& settling);

}  // namespace relume
