// Settings of the hash grid, shared by the techniques that use one.
#pragma once

#include "settings/setting.h"
#include "techniques/spatial/hash_grid/cell.h"

namespace relume {

/// Maximum number of slots of a table.
inline constexpr int kMostSlots = 1 << 28;

struct HashGridSettings {
  float cell_size = 8;  ///< edge of a cell in footprints of a pixel
  bool jitter = true;
  int normal_bins = 2;
  int direction_bins = 0;
  int roughness_bins = 0;
  int max_count = 1024;
  int max_frames = 0;  ///< frames that a history averages, besides max_count; 0: no limit
  int max_age = 32;
  int min_count = 8;
  int inherited_count = 128;
  UndersampledCells undersampled_cells = UndersampledCells::neighbours;
  int coarser_levels = 1;  ///< levels of UndersampledCells::neighbours_coarser
  float clamp = 0;
  float change_detection = 4;
  int max_cells = 0;  ///< maximum number of slots kept from frame to frame; 0: from the sizes of image and memory
};

SettingList describe(HashGridSettings& settings);

}  // namespace relume
