// Views of single rooms of the bases, by the kind of their lamps.
#pragma once

#include <cstdint>
#include <optional>

#include "builtin_scenes/base_plan.h"
#include "experiments/setup/scenes.h"

namespace relume {

struct BaseRoomView {
  ExperimentScene scene;  ///< the base, seen from a corner of the room at eye level
  BaseRoom room;
};

inline constexpr BaseLamps kBaseLamps[] = {BaseLamps::strips, BaseLamps::panels, BaseLamps::screens, BaseLamps::dim,
                                           BaseLamps::skylight};

/// "strips", "panels", "screens", "dim lamps", "skylight".
const char* name_of(BaseLamps lamps);

/// The first room with these lamps in the plan of `base-SEED`, two indirect rays; std::nullopt if there is none.
std::optional<BaseRoomView> base_room_view(uint32_t seed, BaseLamps lamps);

}  // namespace relume
