// Settings of path space filtering, shared by the caches derived from it.
#pragma once

#include "techniques/spatial/hash_grid/settings.h"

namespace relume {

struct PathSpaceFilterSettings {
  HashGridSettings grid;
  float min_roughness = 0.2f;  ///< roughness below which lobes count as specular
  int edge_rays = 16;
  bool split = false;
  float refine = 0;  ///< standard errors; 0: no finer cells
};

/// Names without the prefix "psf.".
SettingList describe(PathSpaceFilterSettings& settings);

}  // namespace relume
