// Settings of light selection from Markov chains.
#pragma once

#include "techniques/spatial/markov_grid/settings.h"

namespace relume {

struct MarkovChainLightsSettings {
  float base_fraction = 0.2f;
  float least_alpha = 0.05f;
  int most_count = 64;
  MarkovGridSettings grid;
};

/// Names without the prefix "mcls.".
SettingList describe(MarkovChainLightsSettings& settings);

}  // namespace relume
