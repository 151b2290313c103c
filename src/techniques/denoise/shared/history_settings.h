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
                  "Maximum history length in samples while the camera moves",
                  {.min = 1, .max = 1024, .biases = true}});
  list.push_back({"max-history-changed",
                  &s.max_history_changed,
                  "Maximum history length in samples while objects or lights move",
                  {.min = 1, .max = 1024, .biases = true}});
  list.push_back({"newest",
                  &s.newest,
                  "Weight of the newest frame in the image while something moves; values below 1 smooth edges",
                  {.min = 0.01, .max = 1, .biases = true}});
}

}  // namespace relume
