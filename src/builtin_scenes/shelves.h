// Shelves of the warehouses.
#pragma once

#include <vector>

#include "builtin_scenes/builder.h"

namespace relume {

/// Adds loaded shelves, once per matrix: 3.6 m wide (x), 0.9 m deep (z) and 2.5 m high about the centre of their floor.
/// The highest board has its underside at 1.85 m.
void add_shelves(SceneBuilder& builder, const std::vector<Mat4>& places);

}  // namespace relume
