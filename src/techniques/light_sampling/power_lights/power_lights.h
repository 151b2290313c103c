// Lights in proportion to their power, by an alias table.
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

/// Entries for PowerLights. What lights at infinity send through the scene grows with its cross-section and says little
/// of what arrives at a point, so as a group they get half of the samples whenever there are finite lights too.
/// Lights at infinity take part as `infinity` says.
std::vector<AliasEntry> build_power_lights(const LightsView& lights,
                                           LightsAtInfinity infinity = LightsAtInfinity::worth_sampling);

}  // namespace relume
