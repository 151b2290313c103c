// Build functions of the built-in scenes.
#pragma once

#include "scene/scene.h"

namespace relume {

Scene build_cornell();
Scene build_cornell_closed();
Scene build_cornell_spheres();
Scene build_cornell_mirror();
Scene build_cornell_water();
Scene build_cornell_glass();
Scene build_corridor();
Scene build_warehouse();
Scene build_cover();
Scene build_turntable();
Scene build_slit();
Scene build_door();
Scene build_mine();
Scene build_city();
Scene build_lamp_room();
Scene build_furnace();

}  // namespace relume
