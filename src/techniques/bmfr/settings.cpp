#include "techniques/bmfr/settings.h"

namespace relume {

SettingList describe(BmfrSettings& s) {
  return {
      {"max-history",
       &s.max_history,
       "Samples that the light at a surface is averaged over at most while the camera moves",
       {.min = 1, .max = 1024, .biases = true}},
      {"max-history-changed",
       &s.max_history_changed,
       "The same while objects or lights move",
       {.min = 1, .max = 1024, .biases = true}},
      {"max-fits", &s.max_fits, "Fits that are averaged at most", {.min = 1, .max = 1024, .biases = true}},
      {"noise",
       &s.noise,
       "Random numbers added to features, which tells those apart that are alike throughout a block",
       {.min = 0, .max = 1, .biases = true}},
      {"detail",
       &s.detail,
       "What features do not explain is kept as far as it exceeds this many variances of the noise; 0: nothing is",
       {.min = 0, .max = 1000, .biases = true}},
      {"newest",
       &s.newest,
       "Weight of a frame in the picture while something moves; below 1 edges are smooth",
       {.min = 0.01, .max = 1, .biases = true}},
  };
}

}  // namespace relume
