// pbrt's current transformation matrix.
#pragma once

#include <array>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "scene/scene.h"

namespace relume::pbrt {

using Matrix = glm::dmat4;

/// Matrices at the start and at the end of the shutter interval.
struct TransformSet {
  std::array<Matrix, 2> at{Matrix(1), Matrix(1)};

  bool is_animated() const { return at[0] != at[1]; }
};

/// From world to camera space, as pbrt's LookAt: +x right, +y up, +z ahead. Identity if the points coincide.
Matrix look_at_matrix(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up);
Matrix rotation_matrix(double degrees, const glm::dvec3& axis);
/// Inverse; identity if there is none.
Matrix inverse_or_identity(const Matrix& matrix);

Mat4 narrow(const Matrix& matrix);

/// Whether all elements are finite and the last row is (0, 0, 0, 1).
bool is_affine(const Matrix& matrix);

/// Whether translation, rotation and scale of decompose() give the matrix.
bool is_decomposable(const Mat4& matrix);

}  // namespace relume::pbrt
