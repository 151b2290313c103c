// The octahedral map of equal areas between directions and the unit square (P. Clarberg, "Fast Equal-Area Mapping of
// the (Hemi)Sphere using SIMD", Journal of Graphics Tools 13(3), 2008), which pbrt uses for images of directions.
#pragma once

#include "relume/image.h"

namespace relume::pbrt {

/// Direction of a point of [0, 1]²; the centre is +Z, the corners are -Z.
Vec3 direction_of_square(const Vec2& point);

/// Point of a unit direction.
Vec2 square_of_direction(const Vec3& direction);

/// Bilinear interpolation of a square image of directions; the image continues across its edges.
Rgb look_up(const Image& image, const Vec3& direction);

}  // namespace relume::pbrt
