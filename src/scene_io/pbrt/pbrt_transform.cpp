#include "scene_io/pbrt/pbrt_transform.h"

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "scene_io/decompose.h"

namespace relume::pbrt {

Matrix look_at_matrix(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up) {
  const glm::dvec3 ahead = glm::normalize(target - eye);
  glm::dvec3 right = glm::cross(up, ahead);
  if (!(glm::length(right) > 1e-12)) right = glm::cross(glm::dvec3(ahead.y, ahead.z, ahead.x), ahead);
  right = glm::normalize(right);
  const Matrix from_camera(glm::dvec4(right, 0), glm::dvec4(glm::cross(ahead, right), 0), glm::dvec4(ahead, 0),
                           glm::dvec4(eye, 1));
  return inverse_or_identity(from_camera);
}

Matrix rotation_matrix(double degrees, const glm::dvec3& axis) {
  return glm::length(axis) > 0 ? glm::rotate(Matrix(1), glm::radians(degrees), axis) : Matrix(1);
}

Matrix inverse_or_identity(const Matrix& matrix) {
  const Matrix inverse = glm::inverse(matrix);
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      if (!std::isfinite(inverse[c][r])) return Matrix(1);
    }
  }
  return inverse;
}

Mat4 narrow(const Matrix& matrix) { return Mat4(matrix); }

bool is_affine(const Matrix& matrix) {
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 3; ++r) {
      if (!(std::fabs(matrix[c][r]) < 1e30)) return false;
    }
    if (std::fabs(matrix[c][3] - (c == 3 ? 1 : 0)) > 1e-6) return false;
  }
  return true;
}

bool is_decomposable(const Mat4& matrix) {
  const Transform t = decompose(matrix);
  const Mat3 axes = glm::mat3_cast(t.rotation);
  float size = 0;
  float excess = 0;
  for (int c = 0; c < 3; ++c) {
    size = std::max(size, glm::length(Vec3(matrix[c])));
    excess = std::max(excess, glm::distance(Vec3(matrix[c]), axes[c] * t.scale[c]));
  }
  return excess <= 1e-4f * size;
}

}  // namespace relume::pbrt
