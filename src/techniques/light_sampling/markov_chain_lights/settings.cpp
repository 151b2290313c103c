#include "techniques/light_sampling/markov_chain_lights/settings.h"

#include <utility>

namespace relume {

SettingList describe(MarkovChainLightsSettings& s) {
  SettingList list = {
      {"base-fraction",
       &s.base_fraction,
       "Fraction of lights chosen by the light tree where a drawn cell has a light",
       {.min = 0.01, .max = 1}},
      {"least-alpha",
       &s.least_alpha,
       "Least weight of a new score in the mean of a cell's light",
       {.min = 1e-4, .max = 1}},
      {"most-count",
       &s.most_count,
       "Number of scores from which on a cell weighs all scores alike",
       {.min = 1, .max = 65535}},
  };
  for (Setting& setting : describe(s.grid)) list.push_back(std::move(setting));
  return list;
}

}  // namespace relume
