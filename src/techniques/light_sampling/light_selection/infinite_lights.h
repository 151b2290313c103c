// Lights at infinity, for strategies that can only tell near lights apart: as a group they get a fixed share of the
// samples, and within it are chosen in proportion to their power.
#pragma once

#include <vector>

#include "sampling/alias_table.h"
#include "sampling/choose.h"
#include "techniques/light_sampling/light_selection/light_selection.h"

namespace relume {

struct InfiniteLights {
  AliasTable table;  ///< over lights first, first + 1, …
  LightId first = 0;
  float share = 0;  ///< of all samples; 0: there are none, 1: there is nothing else

  /// Whether the number falls to this group; it becomes what is left of it either way.
  RELUME_HD bool takes(ReusableNumber& n) const { return takes_share(share, n); }
  RELUME_HD LightSelection sample(ReusableNumber n) const {
    const DiscreteSample s = table.sample(n);
    return {first + s.index, share * s.pmf, s.u};
  }
  RELUME_HD float pmf(LightId light) const { return table.empty() ? 0.0f : share * table.pmf(light - first); }
};

/// Which lights at infinity a strategy samples.
enum class LightsAtInfinity : int {
  unreachable,     ///< only those without extent, which no sampled direction finds
  worth_sampling,  ///< all but a constant environment, which the BSDF samples as well
  all,
};

/// Whether a strategy samples the light; finite ones always.
bool takes_part(const LightsView& lights, LightId light, LightsAtInfinity infinity = LightsAtInfinity::worth_sampling);

/// Entries for InfiniteLights::table; none if nothing at infinity takes part.
std::vector<AliasEntry> build_infinite_lights(const LightsView& lights,
                                              LightsAtInfinity infinity = LightsAtInfinity::worth_sampling);

/// The group, if `finite` says whether any other light emits: half of the samples where there are both.
InfiniteLights make_infinite_lights(const LightsView& lights, const std::vector<AliasEntry>& entries, bool finite);

}  // namespace relume
