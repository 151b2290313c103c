// Translation, rotation and scale of a matrix.
#pragma once

#include "scene/scene.h"

namespace relume {

/// Parts of an affine matrix; shear is lost. An axis without length keeps its direction and gets scale 0.
Transform decompose(const Mat4& matrix);

}  // namespace relume
