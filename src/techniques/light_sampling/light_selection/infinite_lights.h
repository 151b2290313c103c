// The group of lights at infinity, for strategies that compare lights by position: a fixed share of the samples,
// divided by power.
#pragma once

#include <vector>

#include "sampling/alias_table.h"
#include "sampling/choose.h"
#include "techniques/light_sampling/light_selection/light_selection.h"

namespace relume {

struct InfiniteLights {
  AliasTable table;  ///< over lights first, first + 1, …
  LightId first = 0;
  float share = 0;  ///< of all samples; 0: no lights in the group, 1: no other lights

  /// Whether `n` selects this group; rescales `n` to [0, 1).
  RELUME_HD bool takes(ReusableNumber& n) const { return takes_share(share, n); }
  RELUME_HD LightSelection sample(ReusableNumber n) const {
    const DiscreteSample s = table.sample(n);
    return {first + s.index, share * s.pmf, s.u};
  }
  RELUME_HD float pmf(LightId light) const { return table.empty() ? 0.0f : share * table.pmf(light - first); }
};

/// Lights at infinity that a strategy samples.
enum class LightsAtInfinity : int {
  unreachable,     ///< only those without extent, which BSDF sampling cannot hit
  worth_sampling,  ///< all except a constant environment, which the BSDF samples at least as well
  all,
};

/// Whether a strategy samples `light`; true for all finite lights.
bool takes_part(const LightsView& lights, LightId light, LightsAtInfinity infinity = LightsAtInfinity::worth_sampling);

/// Entries for InfiniteLights::table; empty if no light at infinity takes part.
std::vector<AliasEntry> build_infinite_lights(const LightsView& lights,
                                              LightsAtInfinity infinity = LightsAtInfinity::worth_sampling);

/// A group that views `entries`. Its share is one half if other lights emit (`finite`), otherwise 1.
InfiniteLights make_infinite_lights(const LightsView& lights, View<const AliasEntry> entries, bool finite);

}  // namespace relume
