// Meshes of quadrics about +Z, with the parameters of pbrt's and Mitsuba's shapes.
#pragma once

#include "scene/scene.h"

namespace relume {

/// Segments of a full turn; the area of a tessellated sphere is 0.1 % too small.
inline constexpr int kQuadricSegments = 96;

/// Part of a sphere about the origin between the heights `z_min` < `z_max`, up to the angle `phi_max_rad` from +X
/// towards +Y. Texture coordinates in pbrt's terms: u = φ / φ_max and v, from 0 at z_min to 1 at z_max, which the mesh
/// stores as (u, 1 - v).
struct SphereShape {
  float radius = 1;
  float z_min = -1;
  float z_max = 1;
  float phi_max_rad = 2 * kPi;
};

/// The front faces outwards.
Mesh sphere_mesh(const SphereShape& shape, int segments = kQuadricSegments);

/// Part of a disk in the plane z = `height`: u = φ / φ_max, v = 1 at the inner radius and 0 at the outer.
struct DiskShape {
  float height = 0;
  float radius = 1;
  float inner_radius = 0;
  float phi_max_rad = 2 * kPi;
};

/// The front faces +Z.
Mesh disk_mesh(const DiskShape& shape, int segments = kQuadricSegments);

/// Part of an open cylinder: u = φ / φ_max, v = 0 at z_min and 1 at z_max.
struct CylinderShape {
  float radius = 1;
  float z_min = -1;
  float z_max = 1;
  float phi_max_rad = 2 * kPi;
};

/// The front faces outwards.
Mesh cylinder_mesh(const CylinderShape& shape, int segments = kQuadricSegments);

}  // namespace relume
