// Lists of lights from the visible sets of a scene.
#pragma once

#include <vector>

#include "relume/scene.h"
#include "techniques/light_sampling/static_light_lists/build_lists.h"

namespace relume {

/// Lists, for each cell of a grid over the boxes of `sets`, the lights that are visible from the boxes that overlap the
/// cell. Lights outside all boxes are on all lists. `cell_size`: metres; 0: the largest size with a whole number of
/// cells in every box, or 1/24 of the longest side if that is less than 1/128 of it. Reads the lights on the host.
LightListData lists_from_visible_sets(const LightsView& lights, const std::vector<VisibleSet>& sets, float cell_size);

}  // namespace relume
