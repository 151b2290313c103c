// KHR_draco_mesh_compression:
// https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos/KHR_draco_mesh_compression
#include <cstring>
#include <memory>

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>

#include "scene_io/gltf/gltf_primitive.h"
#include "scene_io/gltf/gltf_value.h"

namespace relume::gltf {
namespace {

constexpr const char* kExtension = "KHR_draco_mesh_compression";

int component_type_of(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8: return TINYGLTF_COMPONENT_TYPE_BYTE;
    case draco::DT_UINT8: return TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    case draco::DT_INT16: return TINYGLTF_COMPONENT_TYPE_SHORT;
    case draco::DT_UINT16: return TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    case draco::DT_INT32: return TINYGLTF_COMPONENT_TYPE_INT;
    case draco::DT_UINT32: return TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    case draco::DT_FLOAT32: return TINYGLTF_COMPONENT_TYPE_FLOAT;
    case draco::DT_FLOAT64: return TINYGLTF_COMPONENT_TYPE_DOUBLE;
    default: return 0;
  }
}

ByteSpan compressed_bytes(const Document& document, const tinygltf::Value& extension) {
  const int view = integer_member(extension, "bufferView", -1);
  if (view < 0 || static_cast<size_t>(view) >= document.views.size())
    document.damaged(fmt::format("Draco data refer to missing buffer view {}", view));
  return view_bytes(document, static_cast<size_t>(view));
}

std::unique_ptr<draco::Mesh> decode(const Document& document, ByteSpan bytes) {
  try {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::Decoder decoder;
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    if (result.ok()) return std::move(result).value();
  } catch (const std::exception&) {
    // std::bad_alloc or std::length_error: a damaged header with absurd sizes.
  }
  document.damaged("its Draco data are damaged");
}

/// Copies the attribute's values in the order of the mesh's points. Each index is checked: damaged data may decode to
/// any mapping.
DracoAttribute copy_attribute(const Document& document, const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                              bool normalized) {
  DracoAttribute copy;
  ElementSource& source = copy.source;
  source.count = mesh.num_points();
  source.component_type = component_type_of(attribute.data_type());
  source.components = attribute.num_components();
  source.normalized = normalized;
  source.stride = component_size(source.component_type) * static_cast<size_t>(source.components);
  const bool mapped = attribute.is_mapping_identity() || attribute.indices_map_size() >= source.count;
  if (source.stride == 0 || !mapped || !attribute.buffer()) document.damaged("a Draco attribute is damaged");
  copy.bytes.resize(source.count * source.stride);
  const size_t available = attribute.buffer()->data_size();
  for (size_t i = 0; i < source.count; ++i) {
    const auto value = attribute.mapped_index(draco::PointIndex(static_cast<uint32_t>(i)));
    const int64_t position = attribute.GetBytePos(value);
    if (position < 0 || static_cast<size_t>(position) + source.stride > available)
      document.damaged("a Draco attribute is damaged");
    std::memcpy(copy.bytes.data() + i * source.stride, attribute.buffer()->data() + position, source.stride);
  }
  source.data = copy.bytes.data();
  return copy;
}

bool is_normalized(const Document& document, const tinygltf::Primitive& primitive, const std::string& name) {
  const auto it = primitive.attributes.find(name);
  const bool exists = it != primitive.attributes.end() && it->second >= 0 &&
                      static_cast<size_t>(it->second) < document.model.accessors.size();
  return exists && document.model.accessors[static_cast<size_t>(it->second)].normalized;
}

}  // namespace

bool is_draco_primitive(const tinygltf::Primitive& primitive) { return primitive.extensions.contains(kExtension); }

DracoPrimitive decode_draco_primitive(const Document& document, const tinygltf::Primitive& primitive) {
  const tinygltf::Value& extension = primitive.extensions.at(kExtension);
  const auto mesh = decode(document, compressed_bytes(document, extension));
  DracoPrimitive decoded;
  if (const tinygltf::Value* attributes = object_member(extension, "attributes")) {
    for (const std::string& name : attributes->Keys()) {
      const int id = integer_member(*attributes, name.c_str(), -1);
      const draco::PointAttribute* attribute =
          id < 0 ? nullptr : mesh->GetAttributeByUniqueId(static_cast<uint32_t>(id));
      if (!attribute) document.damaged(fmt::format("the Draco data lack attribute {} with id {}", name, id));
      decoded.attributes.emplace(name,
                                 copy_attribute(document, *mesh, *attribute, is_normalized(document, primitive, name)));
    }
  }
  decoded.indices.reserve(size_t{3} * mesh->num_faces());
  for (uint32_t f = 0; f < mesh->num_faces(); ++f) {
    for (const draco::PointIndex& corner : mesh->face(draco::FaceIndex(f))) decoded.indices.push_back(corner.value());
  }
  return decoded;
}

}  // namespace relume::gltf
