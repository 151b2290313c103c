#include "techniques/denoise/bmfr/settings.h"

namespace relume {

SettingList describe(BmfrSettings& s) {
  SettingList list = {
      {"max-fits", &s.max_fits, "Fits that are averaged at most", {.min = 1, .max = 1024, .biases = true}},
      {"alpha",
       &s.alpha,
       "Least weight of a frame in the light that is fitted, at rest too; 0.2: as [Koskela19]; 0: only max-history and "
       "max-history-changed limit how long it is averaged",
       {.min = 0, .max = 1, .biases = true}},
      {"noise",
       &s.noise,
       "Random numbers added to features, which tells those apart that are alike throughout a block",
       {.min = 0, .max = 1, .biases = true}},
      {"detail",
       &s.detail,
       "What features do not explain is kept as far as it exceeds this many variances of the noise; 0: nothing is",
       {.min = 0, .max = 1000, .biases = true}},
  };
  add_settings(list, s.history);
  return list;
}

}  // namespace relume
