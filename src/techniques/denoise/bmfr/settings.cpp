#include "techniques/denoise/bmfr/settings.h"

namespace relume {

SettingList describe(BmfrSettings& s) {
  SettingList list = {
      {"max-fits", &s.max_fits, "Maximum number of fits to average", {.min = 1, .max = 1024, .biases = true}},
      {"alpha",
       &s.alpha,
       "Minimum weight of a frame in the accumulated light, at rest too; 0.2: [Koskela19]; 0: only max-history and "
       "max-history-changed limit the history",
       {.min = 0, .max = 1, .biases = true}},
      {"noise",
       &s.noise,
       "Amplitude of the noise added to features, so that the fit tolerates features that are constant throughout a "
       "block",
       {.min = 0, .max = 1, .biases = true}},
      {"detail",
       &s.detail,
       "Keep the difference between light and fit where it exceeds this many variances of the noise; 0: show the fit "
       "alone",
       {.min = 0, .max = 1000, .biases = true}},
  };
  add_settings(list, s.history);
  return list;
}

}  // namespace relume
