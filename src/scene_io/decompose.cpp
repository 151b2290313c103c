#include "scene_io/decompose.h"

namespace relume {

Transform decompose(const Mat4& matrix) {
  Transform t;
  t.translation = Vec3(matrix[3]);
  Mat3 axes(matrix);
  for (int c = 0; c < 3; ++c) {
    t.scale[c] = glm::length(axes[c]);
    axes[c] = t.scale[c] > 0 ? axes[c] / t.scale[c] : Mat3(1)[c];
  }
  if (glm::determinant(axes) < 0) {
    t.scale.x = -t.scale.x;
    axes[0] = -axes[0];
  }
  t.rotation = glm::normalize(glm::quat_cast(axes));
  return t;
}

}  // namespace relume
