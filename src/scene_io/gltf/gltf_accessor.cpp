#include "scene_io/gltf/gltf_accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

#include <fmt/format.h>

namespace relume::gltf {
namespace {

/// Limit on accessors without a buffer view: all zeros, with no file bytes to bound their size.
constexpr size_t kMaxZeroElements = size_t{1} << 24;

const tinygltf::Accessor& accessor_at(const Document& document, int index) {
  if (index < 0 || static_cast<size_t>(index) >= document.model.accessors.size())
    document.damaged(fmt::format("accessor {} does not exist", index));
  return document.model.accessors[static_cast<size_t>(index)];
}

int components_of(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR: return 1;
    case TINYGLTF_TYPE_VEC2: return 2;
    case TINYGLTF_TYPE_VEC3: return 3;
    case TINYGLTF_TYPE_VEC4: return 4;
    case TINYGLTF_TYPE_MAT4: return 16;
    default: return 0;
  }
}

/// First of `count` elements at `offset` of buffer view `view`. Throws Error unless all lie inside the view.
const std::byte* checked_data(const Document& document, int view, size_t offset, size_t count, size_t stride,
                              size_t element_size, int accessor) {
  if (view < 0 || static_cast<size_t>(view) >= document.views.size())
    document.damaged(fmt::format("accessor {} refers to missing buffer view {}", accessor, view));
  const ByteSpan bytes = view_bytes(document, static_cast<size_t>(view));
  const bool fits = offset <= bytes.size() && element_size <= bytes.size() - offset &&
                    (count - 1) <= (bytes.size() - offset - element_size) / stride;
  if (count > 0 && !fits)
    document.damaged(fmt::format("accessor {} ({} elements of {} bytes) goes beyond its buffer view of {} bytes",
                                 accessor, count, element_size, bytes.size()));
  return bytes.data() + (count > 0 ? offset : 0);
}

ElementSource element_source(const Document& document, int index, int components) {
  const tinygltf::Accessor& accessor = accessor_at(document, index);
  ElementSource source;
  source.count = accessor.count;
  source.component_type = accessor.componentType;
  source.components = components_of(accessor.type);
  source.normalized = accessor.normalized;
  if (source.components != components)
    document.damaged(
        fmt::format("accessor {} should have {} components but has {}", index, components, source.components));
  const size_t element_size = component_size(accessor.componentType) * static_cast<size_t>(components);
  if (element_size == 0)
    document.damaged(fmt::format("accessor {} has the unknown component type {}", index, accessor.componentType));
  if (accessor.bufferView == document.no_buffer_view) {
    if (accessor.count > kMaxZeroElements)
      document.damaged(fmt::format("accessor {} has {} elements but no data", index, accessor.count));
    return source;
  }
  const bool has_view =
      accessor.bufferView >= 0 && static_cast<size_t>(accessor.bufferView) < document.model.bufferViews.size();
  const size_t view_stride =
      has_view ? document.model.bufferViews[static_cast<size_t>(accessor.bufferView)].byteStride : 0;
  source.stride = view_stride == 0 ? element_size : view_stride;
  source.data = checked_data(document, accessor.bufferView, accessor.byteOffset, source.count, source.stride,
                             element_size, index);
  return source;
}

template <typename T>
float to_float_component(T value, bool normalized) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<float>(value);
  } else {
    if (!normalized) return static_cast<float>(value);
    // glTF 2.0, §3.6.2.2: both of the two lowest signed integers map to -1.
    return std::max(static_cast<float>(static_cast<double>(value) / std::numeric_limits<T>::max()), -1.0f);
  }
}

template <typename T, typename Out, typename Convert>
void convert_elements(const ElementSource& source, Out* destination, Convert convert) {
  const auto components = static_cast<size_t>(source.components);
  for (size_t i = 0; i < source.count; ++i) {
    for (size_t c = 0; c < components; ++c) {
      T value;
      std::memcpy(&value, source.data + i * source.stride + c * sizeof(T), sizeof(T));
      *destination++ = convert(value);
    }
  }
}

template <typename T>
void convert_floats(const ElementSource& source, float* destination) {
  convert_elements<T>(source, destination, [&](T value) { return to_float_component(value, source.normalized); });
}

/// Widens elements to uint32. Returns false unless the component type is an unsigned integer.
bool convert_to_indices(const ElementSource& source, uint32_t* destination) {
  const auto widen = [](auto value) { return static_cast<uint32_t>(value); };
  switch (source.component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: convert_elements<uint8_t>(source, destination, widen); return true;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: convert_elements<uint16_t>(source, destination, widen); return true;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: convert_elements<uint32_t>(source, destination, widen); return true;
    default: return false;
  }
}

/// Positions and values of a sparse accessor's replacements.
struct SparsePart {
  std::vector<uint32_t> positions;
  ElementSource values;
};

SparsePart read_sparse(const Document& document, int index, const ElementSource& base) {
  const auto& sparse = accessor_at(document, index).sparse;
  // Signedness of these differs between versions of tinygltf.
  const auto negative = [](auto number) { return static_cast<int64_t>(number) < 0; };
  if (negative(sparse.count) || negative(sparse.indices.byteOffset) || negative(sparse.values.byteOffset))
    document.damaged(fmt::format("accessor {} has a negative number in 'sparse'", index));
  const auto count = static_cast<size_t>(sparse.count);
  ElementSource indices;
  indices.count = count;
  indices.component_type = sparse.indices.componentType;
  indices.components = 1;
  indices.stride = component_size(indices.component_type);
  if (indices.stride == 0)
    document.damaged(fmt::format("accessor {} has an unknown component type in 'sparse'", index));
  indices.data = checked_data(document, sparse.indices.bufferView, static_cast<size_t>(sparse.indices.byteOffset),
                              count, indices.stride, indices.stride, index);
  SparsePart part;
  part.positions.resize(count);
  if (!convert_to_indices(indices, part.positions.data()))
    document.damaged(fmt::format("accessor {} has sparse indices that are not unsigned integers", index));
  for (const uint32_t position : part.positions) {
    if (position >= base.count)
      document.damaged(fmt::format("accessor {} has a sparse index beyond its {} elements", index, base.count));
  }
  part.values = base;
  part.values.count = count;
  part.values.stride = component_size(base.component_type) * static_cast<size_t>(base.components);
  part.values.data = checked_data(document, sparse.values.bufferView, static_cast<size_t>(sparse.values.byteOffset),
                                  count, part.values.stride, part.values.stride, index);
  return part;
}

template <typename V>
std::vector<V> read_elements(const Document& document, int index, int components) {
  static_assert(sizeof(V) % sizeof(float) == 0);
  const ElementSource source = element_source(document, index, components);
  std::vector<V> elements(source.count);
  if (source.count > 0) convert_to_floats(source, reinterpret_cast<float*>(elements.data()));
  if (accessor_at(document, index).sparse.isSparse) {
    const SparsePart part = read_sparse(document, index, source);
    std::vector<V> values(part.positions.size());
    if (!values.empty()) convert_to_floats(part.values, reinterpret_cast<float*>(values.data()));
    for (size_t i = 0; i < values.size(); ++i) elements[part.positions[i]] = values[i];
  }
  return elements;
}

}  // namespace

size_t component_size(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 2;
    case TINYGLTF_COMPONENT_TYPE_INT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return 4;
    case TINYGLTF_COMPONENT_TYPE_DOUBLE: return 8;
    default: return 0;
  }
}

size_t accessor_count(const Document& document, int accessor) {
  if (accessor < 0 || static_cast<size_t>(accessor) >= document.model.accessors.size()) return 0;
  return document.model.accessors[static_cast<size_t>(accessor)].count;
}

int accessor_components(const Document& document, int accessor) {
  if (accessor < 0 || static_cast<size_t>(accessor) >= document.model.accessors.size()) return 0;
  const int components = components_of(document.model.accessors[static_cast<size_t>(accessor)].type);
  return components <= 4 ? components : 0;
}

void convert_to_floats(const ElementSource& source, float* destination) {
  const size_t components = static_cast<size_t>(source.components);
  if (!source.data) {
    std::fill_n(destination, source.count * components, 0.0f);
    return;
  }
  switch (source.component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return convert_floats<int8_t>(source, destination);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return convert_floats<uint8_t>(source, destination);
    case TINYGLTF_COMPONENT_TYPE_SHORT: return convert_floats<int16_t>(source, destination);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return convert_floats<uint16_t>(source, destination);
    case TINYGLTF_COMPONENT_TYPE_INT: return convert_floats<int32_t>(source, destination);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return convert_floats<uint32_t>(source, destination);
    case TINYGLTF_COMPONENT_TYPE_DOUBLE: return convert_floats<double>(source, destination);
    default: return convert_floats<float>(source, destination);
  }
}

std::vector<float> read_scalars(const Document& document, int accessor) {
  return read_elements<float>(document, accessor, 1);
}
std::vector<Vec2> read_vec2(const Document& document, int accessor) {
  return read_elements<Vec2>(document, accessor, 2);
}
std::vector<Vec3> read_vec3(const Document& document, int accessor) {
  return read_elements<Vec3>(document, accessor, 3);
}
std::vector<Vec4> read_vec4(const Document& document, int accessor) {
  return read_elements<Vec4>(document, accessor, 4);
}

std::vector<Mat4> read_mat4(const Document& document, int accessor) {
  return read_elements<Mat4>(document, accessor, 16);
}

std::vector<uint32_t> read_indices(const Document& document, int accessor) {
  const ElementSource source = element_source(document, accessor, 1);
  std::vector<uint32_t> indices(source.count, 0);
  if (source.data && source.count > 0 && !convert_to_indices(source, indices.data()))
    document.damaged(
        fmt::format("accessor {} holds vertex indices but its components are not unsigned integers", accessor));
  if (accessor_at(document, accessor).sparse.isSparse) {
    const SparsePart part = read_sparse(document, accessor, source);
    std::vector<uint32_t> values(part.positions.size());
    if (!convert_to_indices(part.values, values.data()))
      document.damaged(
          fmt::format("accessor {} holds vertex indices but its components are not unsigned integers", accessor));
    for (size_t i = 0; i < values.size(); ++i) indices[part.positions[i]] = values[i];
  }
  return indices;
}

}  // namespace relume::gltf
