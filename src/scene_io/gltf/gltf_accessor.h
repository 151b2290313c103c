// Reads accessors: all component types, strides, normalisation and sparse values, with all bounds checked.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/vec.h"
#include "scene_io/gltf/gltf_document.h"

namespace relume::gltf {

/// Elements in memory, already checked to lie inside their view.
struct ElementSource {
  const std::byte* data = nullptr;  ///< nullptr: all zero
  size_t count = 0;
  size_t stride = 0;       ///< distance between elements, in bytes
  int component_type = 0;  ///< TINYGLTF_COMPONENT_TYPE_*
  int components = 0;      ///< 1 … 4
  bool normalized = false;
};

/// Size of a component in bytes; 0 for an unknown type.
size_t component_size(int component_type);

/// Number of elements; 0 for a missing accessor.
size_t accessor_count(const Document& document, int accessor);
/// Number of components per element (1 … 4); 0 for matrices and missing accessors.
int accessor_components(const Document& document, int accessor);

/// Elements as float, vec2, vec3 or vec4, normalised if the accessor specifies it. Throws Error if the accessor is
/// missing, has another number of components or exceeds its buffer.
std::vector<float> read_scalars(const Document& document, int accessor);
std::vector<Vec2> read_vec2(const Document& document, int accessor);
std::vector<Vec3> read_vec3(const Document& document, int accessor);
std::vector<Vec4> read_vec4(const Document& document, int accessor);

/// Elements of a 4 × 4 matrix accessor: floats without padding. Throws Error in the same cases.
std::vector<Mat4> read_mat4(const Document& document, int accessor);

/// Unsigned integers (vertex indices). Throws Error in the same cases, and for signed or floating-point components.
std::vector<uint32_t> read_indices(const Document& document, int accessor);

/// Writes `source.count` · `source.components` floats to `destination`.
void convert_to_floats(const ElementSource& source, float* destination);

}  // namespace relume::gltf
