// Reads vertex attributes and indices of a glTF primitive from accessors or Draco data.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "scene_io/gltf/gltf_accessor.h"

namespace relume::gltf {

/// An attribute decoded by Draco.
struct DracoAttribute {
  Bytes bytes;
  ElementSource source;  ///< points into `bytes`
};

/// A primitive decoded by Draco.
struct DracoPrimitive {
  std::map<std::string, DracoAttribute> attributes;
  std::vector<uint32_t> indices;
};

/// Whether the primitive has KHR_draco_mesh_compression.
bool is_draco_primitive(const tinygltf::Primitive& primitive);
/// Decodes the primitive's compressed data. Throws Error if they are damaged.
DracoPrimitive decode_draco_primitive(const Document& document, const tinygltf::Primitive& primitive);

class PrimitiveReader {
 public:
  PrimitiveReader(const Document& document, const tinygltf::Primitive& primitive);

  /// Number of elements of attribute `name`; 0 if absent.
  size_t count(const std::string& name) const;
  /// Components of attribute `name`, 1 … 4; 0 if absent.
  int components(const std::string& name) const;
  std::vector<Vec2> vec2(const std::string& name) const;
  std::vector<Vec3> vec3(const std::string& name) const;
  std::vector<Vec4> vec4(const std::string& name) const;
  /// The primitive's indices; if absent, 0, 1, 2 … for `vertex_count` vertices.
  std::vector<uint32_t> indices(size_t vertex_count) const;

 private:
  const DracoAttribute* draco(const std::string& name) const;
  int accessor(const std::string& name) const;

  const Document& document_;
  const tinygltf::Primitive& primitive_;
  DracoPrimitive draco_;
};

}  // namespace relume::gltf
