#include "techniques/guiding/markov_chain/settings.h"

#include <utility>

namespace relume {

SettingList describe(MarkovChainSettings& s) {
  SettingList list = {
      {"bsdf-fraction",
       &s.bsdf_fraction,
       "Fraction of directions sampled from the BSDF where a drawn cell has a state",
       {.min = 0.01, .max = 1}},
      {"prior",
       &s.prior,
       "Widens lobes of chains with few targets, in proportion to the solid angle of a cell seen from the target",
       {.min = 0, .max = 1e6}},
      {"least-alpha",
       &s.least_alpha,
       "Least weight of a new target in the averages of its chain",
       {.min = 1e-4, .max = 1}},
      {"most-count",
       &s.most_count,
       "Number of targets from which on a chain weighs all targets alike",
       {.min = 1, .max = 65535}},
      {"recovery", &s.recovery,
       "End a chain when a direction close to the axis of its lobe finds almost no light; off: others replace it"},
      {"nee", &s.nee,
       "Keep next event estimation; off, as in the paper: only lights without extent are sampled, and directions find "
       "all others"},
  };
  for (Setting& setting : describe(s.grid)) list.push_back(std::move(setting));
  return list;
}

}  // namespace relume
