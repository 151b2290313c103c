// Settings of the grids of Markov chains, under the prefix of the technique that uses them.
#pragma once

#include "settings/setting.h"

namespace relume {

struct MarkovGridSettings {
  int cells = 5;
  float adaptive_share = 0.7f;
  float cell_size = 6;
  int static_cells = 64;
  int slots = 4;
  int static_slots = 1 << 17;
  int vertices = 2;
};

SettingList describe(MarkovGridSettings& settings);

}  // namespace relume
