// Settings of the spatially hashed radiance cache.
#pragma once

#include "settings/setting.h"
#include "techniques/radiance_cache/path_space_filter/settings.h"

namespace relume {

/// Pixels that trace an update path per frame.
enum class SharcUpdate : int {
  sparse,  ///< one of each block of 5 × 5
  all
};

/// Cells in which camera paths end.
enum class SharcEnd : int {
  footprint,  ///< those smaller than the segment and the cone of the path
  variance    ///< of these, those whose samples vary little
};

struct SharcSettings {
  SharcUpdate update = SharcUpdate::sparse;
  SharcEnd end = SharcEnd::footprint;
  float variance = 1;
  bool feedback = true;
  int propagation_depth = 4;
  float cell_size = 8;
  bool jitter = true;
  int normal_bins = 2;
  float min_roughness = 0.2f;
  int frames = 32;
  int min_samples = 4;
  int max_age = 64;
  float clamp = 0;
  int max_cells = 0;
};

/// Names without the prefix "sharc.".
SettingList describe(SharcSettings& settings);

/// Settings of the cells.
PathSpaceFilterSettings cell_settings(const SharcSettings& settings);

}  // namespace relume
