// The functions behind the list of built-in scenes.
#pragma once

#include "scene/scene.h"

namespace relume {

Scene build_cornell();
Scene build_cornell_spheres();
Scene build_cornell_mirror();
Scene build_cornell_water();
Scene build_cornell_glass();
Scene build_furnace();

}  // namespace relume
