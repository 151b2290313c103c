// Settings of reservoirs for direct light, and types of settings that all reuse of reservoirs shares.
#pragma once

#include <cstdint>

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

/// Pass::correlated_frames() of reservoirs. A reservoir's share in the reservoir of the k-th later frame is
/// (cap / (cap + 1))^k. The sum over k of these correlations, forwards and backwards, is 1 + 2 · cap.
inline uint32_t frames_correlated_by(int cap) { return 1 + 2 * static_cast<uint32_t>(cap); }

struct RisSettings {
  int candidates = 8;  ///< from light selection; the path's direction is one more
};

SettingList describe(RisSettings& settings);

}  // namespace relume
