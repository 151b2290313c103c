// Vectors and matrices of the public interface, from glm.
#pragma once

#if defined(__CUDACC__) && !defined(CUDA_VERSION)
#include <cuda.h>  // glm 0.9.9 finds the CUDA version only through this header
#endif

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat2x2.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace relume {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using IVec2 = glm::ivec2;
using UVec2 = glm::uvec2;
using UVec3 = glm::uvec3;
using Mat3 = glm::mat3;
using Mat4 = glm::mat4;
using Quaternion = glm::quat;

/// Linear Rec. 709 colour: radiance, reflectance or throughput.
using Rgb = glm::vec3;

inline constexpr float kPi = 3.14159265358979324f;
inline constexpr float kInfinity = __builtin_huge_valf();

}  // namespace relume
