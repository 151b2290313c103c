// Among all lights, for exploration: a blend of three guesses that know nothing of the point ([Dittebrandt20, §4.3]).
#pragma once

#include <vector>

#include "lights/light.h"
#include "sampling/alias_table.h"

namespace relume {

/// Shares of the three in the blend, up to their sum.
struct ExplorationWeights {
  float energy = 1;    ///< by emitted power; > 0, so that every light has its chance
  float change = 1;    ///< lights that changed since the last frame, each alike
  float distance = 1;  ///< by the inverse square of the distance to the camera
};

/// Entries of an alias table over the finite lights. Lights that emit nothing are never chosen; guesses that know no
/// light leave their share to the others.
std::vector<AliasEntry> build_exploration(const LightsView& lights, const Vec3& camera,
                                          const ExplorationWeights& weights);

}  // namespace relume
