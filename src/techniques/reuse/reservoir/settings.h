// Settings of reservoirs for direct light, and types of settings that all reuse of reservoirs shares.
#pragma once

#include "settings/setting.h"

namespace relume {

/// Weights with which reservoirs combine.
enum class ReuseCorrection : int {
  exact,    ///< balance and pairwise weights with occlusion in the targets; reservoirs end where their light may change
  lagging,  ///< the same, but reservoirs survive moving geometry, with rays in the current scene
  basic,    ///< weights without occlusion, which darkens shadows
};

/// Reservoirs that the next frame reuses: those before or after the reuse of neighbouring pixels.
enum class ReuseFeedback : int { temporal, spatial };

/// Upper bound of the number of neighbouring pixels.
inline constexpr int kMostReuseNeighbours = 8;

struct RisSettings {
  int candidates = 8;  ///< from light selection; the path's direction is one more
};

SettingList describe(RisSettings& settings);

}  // namespace relume
