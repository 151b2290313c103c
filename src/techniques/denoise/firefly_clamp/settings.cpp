#include "techniques/denoise/firefly_clamp/settings.h"

namespace relume {

SettingList describe(FireflySettings& s) {
  return {{"limit",
           &s.limit,
           "Scale samples down that are brighter than this times the mean of their neighbours, before histories and "
           "denoisers see them; 0: none. Loses the energy that it cuts",
           {.min = 0, .max = 1e6, .biases = true}}};
}

}  // namespace relume
