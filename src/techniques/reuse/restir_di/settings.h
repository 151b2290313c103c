// Settings of ReSTIR DI.
#pragma once

#include "settings/setting.h"

namespace relume {

/// Weights with which reservoirs combine.
enum class ReuseCorrection : int {
  exact,    ///< balance and pairwise weights with occlusion in the targets; reservoirs end where geometry moves
  lagging,  ///< the same, but reservoirs survive moving geometry, with rays in the current scene
  basic,    ///< weights without occlusion, which darkens shadows
};

/// Reservoirs that the next frame reuses: those before or after the reuse of neighbouring pixels.
enum class ReuseFeedback : int { temporal, spatial };

struct RestirSettings {
  ReuseCorrection correction = ReuseCorrection::exact;
  ReuseFeedback feedback = ReuseFeedback::spatial;
  int cap = 20;        ///< confidence of a history, in frames; 0: no temporal reuse
  int neighbours = 3;  ///< 0: no spatial reuse
  float radius = 30;   ///< of the neighbours, pixels
};

SettingList describe(RestirSettings& settings);

/// Upper bound of restir.neighbours.
inline constexpr int kMostReuseNeighbours = 8;

}  // namespace relume
