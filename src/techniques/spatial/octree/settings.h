// Settings of the octree.
#pragma once

#include "settings/setting.h"

namespace relume {

/// Records that thresholds count: all, or those that an estimator can use.
enum class OctreeCount : int { all, useful };

struct OctreeSettings {
  int collapse = 2048;
  int split = 4096;
  bool scale = true;
  OctreeCount count = OctreeCount::all;
  int max_depth = 16;
  int vertices = 2;
  float jitter = 0;
  int longest_epoch = 64;
};

SettingList describe(OctreeSettings& settings);

}  // namespace relume
