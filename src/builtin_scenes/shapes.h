// Triangle meshes of simple shapes, in metres. All have outward unit normals that agree with the winding
// (counter-clockwise seen from outside) and one set of texture coordinates.
#pragma once

#include <functional>
#include <vector>

#include "scene/scene.h"

namespace relume {

/// Parallelogram corner + s · u + t · v with s, t in [0, 1]; its front faces u × v.
Mesh quad(const Vec3& corner, const Vec3& u, const Vec3& v);

/// Axis-aligned box facing outwards. low < high in every component.
Mesh box(const Vec3& low, const Vec3& high);

/// Sphere about the origin by `levels` subdivisions of the icosahedron: 20 · 4^levels triangles of similar size.
Mesh icosphere(float radius, int levels);

/// Disc in the plane y = 0 about the origin, facing up.
Mesh disc(float radius, int segments);

/// Upright cylinder from y = 0 to `height` about the axis +Y, with caps if `capped`.
Mesh cylinder(float radius, float height, int segments, bool capped);

/// Surface of revolution about +Y. The profile's points are (distance from the axis, height). The outside is to the
/// right of the profile: an upward profile at positive radius faces away from the axis. Shading is smooth except where
/// the profile turns by more than 40 degrees.
Mesh lathe(const std::vector<Vec2>& profile, int segments);

/// Height field y(x, z) over [low.x, high.x] × [low.y, high.y] (the second component is z), facing up.
Mesh height_field(const Vec2& low, const Vec2& high, int cells_x, int cells_z,
                  const std::function<float(float, float)>& height);

/// Grid of (count_u + 1) · (count_v + 1) points position(u, v) with u, v in [0, 1]. The front faces ∂u × ∂v. Normals
/// are averaged over the triangles, across the seam if the first and last column coincide.
Mesh parametric_surface(int count_u, int count_v, const std::function<Vec3(float, float)>& position);

/// Tube of radius `tube_radius` along the (p, q) torus knot: 2 · count_along · count_around triangles. The knot
/// winds on a torus of radii `radius` and 0.5 · radius about +Y. p and q are coprime.
Mesh torus_knot(int p, int q, float radius, float tube_radius, int count_along, int count_around);

/// Adds the triangles of `part` to `mesh`, which keeps its material and name.
void append(Mesh& mesh, const Mesh& part);

/// `mesh` under an affine matrix. Normals are transformed by the inverse transpose; mirroring also reverses the
/// winding.
Mesh transformed(Mesh mesh, const Mat4& matrix);

/// `mesh` with reversed winding and normals.
Mesh flipped(Mesh mesh);

/// `mesh` without normals, for flat shading.
Mesh flat_shaded(Mesh mesh);

/// Removes triangles without area, which grids contain where a row shrinks to a point.
void remove_degenerate(Mesh& mesh);

/// Replaces normals with the area-weighted average over the triangles that share a vertex *index*.
void smooth_normals(Mesh& mesh);

/// Matrices for scene construction; angles are in degrees.
Mat4 translation(const Vec3& offset);
Mat4 rotation_y(float degrees);
Mat4 rotation(float degrees, const Vec3& axis);
Mat4 scaling(const Vec3& factors);

}  // namespace relume
