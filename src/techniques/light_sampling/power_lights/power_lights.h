// Light selection in proportion to power, by an alias table.
#pragma once

#include <vector>

#include "sampling/alias_table.h"
#include "techniques/light_sampling/light_selection/infinite_lights.h"
#include "techniques/light_sampling/light_selection/light_selection.h"

namespace relume {

struct PowerLights {
  AliasTable table;

  RELUME_HD LightSelection sample(ReusableNumber n) const {
    if (table.empty()) return {};
    const DiscreteSample s = table.sample(n);
    return {s.index, s.pmf, s.u};
  }
  RELUME_HD float pmf(LightId light) const { return table.empty() ? 0.0f : table.pmf(light); }
};

/// Entries for PowerLights, with the lights at infinity that `infinity` selects. If both groups emit, each gets half of
/// the samples: power at infinity grows with the scene's cross-section, a poor guide to the light at a point.
std::vector<AliasEntry> build_power_lights(const LightsView& lights,
                                           LightsAtInfinity infinity = LightsAtInfinity::worth_sampling);

}  // namespace relume
