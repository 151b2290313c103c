// Meshes over a grid of two parameters.
#pragma once

#include <functional>

#include "scene/scene.h"

namespace relume {

struct GridVertex {
  Vec3 position;
  Vec3 normal;  ///< unit
};

/// Mesh of count_u · count_v cells with the vertices at u, v in [0, 1] and the texture coordinates (u, 1 - v). The
/// front faces ∂u × ∂v. Triangles without area are left out.
Mesh grid_mesh(int count_u, int count_v, const std::function<GridVertex(float u, float v)>& vertex);

}  // namespace relume
