// Settings of the visibility light cache.
#pragma once

#include "settings/setting.h"
#include "techniques/light_sampling/visibility_light_cache/change_measure.h"

namespace relume {

/// Lights at infinity: entries of the regions' lists, or a separate group with a fixed share of the samples.
enum class CachedInfinity : int { entries, apart };

struct VisibilityLightCacheSettings {
  int bucket_size = 32;
  float exploration = 0.1f;
  bool learn_exploration = false;  ///< whether regions learn their own share, above:
  float exploration_floor = 0.02f;
  float hysteresis = 0.75f;
  int max_samples = 4096;
  int memory = 4;
  float even_buckets = 0.1f;
  float energy_weight = 1;
  float change_weight = 1;
  ChangeMeasure change_measure = ChangeMeasure::flag;
  float distance_weight = 1;
  int exploration_cells = 32;
  CachedInfinity infinite = CachedInfinity::apart;

  bool lists_infinite() const { return infinite == CachedInfinity::entries; }
};

SettingList describe(VisibilityLightCacheSettings& settings);

}  // namespace relume
