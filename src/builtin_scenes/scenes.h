// Build functions of the built-in scenes.
#pragma once

#include <cstdint>
#include <string>

#include "scene/scene.h"

namespace relume {

/// Named "base-SEED".
Scene build_base(uint32_t seed);
Scene build_cornell();
Scene build_cornell_closed();
Scene build_cornell_spheres();
Scene build_cornell_mirror();
Scene build_cornell_water();
Scene build_cornell_glass();
Scene build_corridor();
Scene build_warehouse();
Scene build_warehouse_140();
Scene build_warehouse_399();
Scene build_warehouse_rooms();
Scene build_cover();
Scene build_turntable();
Scene build_turntable_spot();
Scene build_skylight();
Scene build_slit();
Scene build_door();
/// `sun_diameter_deg`: angular diameter of the sun; its irradiance does not depend on it.
Scene build_mine(std::string name, float sun_diameter_deg);
Scene build_city();
Scene build_lamp_room();
Scene build_furnace();

}  // namespace relume
