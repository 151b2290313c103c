// Splits a matrix into translation, rotation and scale.
#pragma once

#include "scene/scene.h"

namespace relume {

/// Translation, rotation and scale of an affine matrix; shear is lost. A mirrored matrix gets a negative x scale. A
/// zero-length column gets scale 0 and the coordinate axis as its direction.
Transform decompose(const Mat4& matrix);

}  // namespace relume
