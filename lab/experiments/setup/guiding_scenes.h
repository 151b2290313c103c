// Scenes of the experiment on guiding: mines, and a room with a skylight.
#pragma once

#include <string>

#include "experiments/setup/scenes.h"

namespace relume {

/// Image scale of the mine that gives each region about a thousand samples per frame, as in the paper.
inline constexpr int kMineScale = 3;

/// The built-in mine; `environment`: whether next event estimation samples the environment.
ExperimentScene mine(std::string name, bool environment, int scale);

/// Image scale of the size at which guiding has to gain the most, 1344×756 pixels.
inline constexpr int kLargeScale = 7;

/// A built-in mine with a smaller sun, whose light is not sampled. `suffix`: end of its name.
ExperimentScene built_in_mine(const char* name, const char* suffix, int scale);

/// The room with holes in its ceiling, with the environment sampled. `suffix`: end of its name.
ExperimentScene skylight(const char* suffix, int scale);

/// Mine with a smaller sun of the same power: guiding gains more when fewer directions matter.
ExperimentScene mine_with_sun(float degrees);

}  // namespace relume
