// Settings of Markov chain path guiding.
#pragma once

#include "techniques/spatial/markov_grid/settings.h"

namespace relume {

struct MarkovChainSettings {
  float bsdf_fraction = 0.5f;
  float prior = 0.2f;
  float least_alpha = 0.01f;
  int most_count = 1024;
  bool recovery = true;
  bool nee = true;
  MarkovGridSettings grid;
};

/// Names without the prefix "mcpg.".
SettingList describe(MarkovChainSettings& settings);

}  // namespace relume
