// Settings that denoisers with a history of light share.
#pragma once

#include "settings/setting.h"

namespace relume {

/// Adds to `list` how long the light at a surface and the filtered pictures are averaged.
inline void add_history_settings(SettingList& list, int& max_history, int& max_history_changed, float& newest) {
  list.push_back({"max-history",
                  &max_history,
                  "Samples that the light at a surface is averaged over at most while the camera moves",
                  {.min = 1, .max = 1024, .biases = true}});
  list.push_back({"max-history-changed",
                  &max_history_changed,
                  "The same while objects or lights move",
                  {.min = 1, .max = 1024, .biases = true}});
  list.push_back({"newest",
                  &newest,
                  "Weight of a frame in the picture while something moves; below 1 edges are smooth",
                  {.min = 0.01, .max = 1, .biases = true}});
}

}  // namespace relume
