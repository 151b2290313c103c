// Where things may stand in the world, and which way they face.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// Coordinates and scales in the world reach this far, metres: the squared area of a triangle that wide is still finite
/// in single precision.
inline constexpr float kMaxCoordinate = 1e9f;

/// Whether an affine matrix moves and scales by no more than kMaxCoordinate; false for what is not a number, too.
bool within_reach(const Mat4& matrix);

/// Unit vector along `v`, however short; zero if it has no direction.
Vec3 direction_of(const Vec3& v);

/// Right-handed orthonormal axes of a matrix that may scale or shear: Z as it is, Y as near as can be. std::nullopt if
/// the matrix collapses Y or Z, or makes them parallel.
std::optional<Mat3> orientation(const Mat4& to_world);

/// Throws Error unless every node that holds something stands within kMaxCoordinate; `world` has one matrix a node.
void check_placement(const Scene& scene, std::span<const Mat4> world, const std::string& place);

}  // namespace relume
