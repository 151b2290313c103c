// Valid positions and orientations in world space.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// Largest absolute coordinate and scale in world space, metres. The squared area of a triangle of this size is finite
/// in single precision.
inline constexpr float kMaxCoordinate = 1e9f;

/// Whether an affine matrix moves and scales by at most kMaxCoordinate; false for NaN.
bool within_reach(const Mat4& matrix);

/// Unit vector along `v` of any length; zero for a zero vector.
Vec3 direction_of(const Vec3& v);

/// Right-handed orthonormal axes of a matrix that may scale or shear: Z is exact, Y as close as possible. std::nullopt
/// if the matrix collapses Y or Z, or makes them parallel.
std::optional<Mat3> orientation(const Mat4& to_world);

/// Throws Error unless every node with content is within kMaxCoordinate. `world`: one matrix per node.
void check_placement(const Scene& scene, std::span<const Mat4> world, const std::string& place);

}  // namespace relume
