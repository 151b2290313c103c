// Settings common to denoisers with a history of light.
#pragma once

#include "settings/setting.h"

namespace relume {

/// Lengths of the averages of light at surfaces and of filtered images.
struct DenoiserHistorySettings {
  int max_history = 32;
  int max_history_changed = 8;
  float newest = 0.2f;
};

/// Appends them to a denoiser's settings.
inline void add_settings(SettingList& list, DenoiserHistorySettings& s) {
  list.push_back({"max-history",
                  &s.max_history,
                  "Samples that the light at a surface is averaged over at most while the camera moves",
                  {.min = 1, .max = 1024, .biases = true}});
  list.push_back({"max-history-changed",
                  &s.max_history_changed,
                  "The same while objects or lights move",
                  {.min = 1, .max = 1024, .biases = true}});
  list.push_back({"newest",
                  &s.newest,
                  "Weight of a frame in the image while something moves; below 1 edges are smooth",
                  {.min = 0.01, .max = 1, .biases = true}});
}

}  // namespace relume
