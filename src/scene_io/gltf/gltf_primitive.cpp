#include "scene_io/gltf/gltf_primitive.h"

#include <numeric>

#include <fmt/format.h>

namespace relume::gltf {
namespace {

template <typename V>
std::vector<V> convert(const Document& document, const ElementSource& source, const std::string& name) {
  if (source.components != V::length())
    document.damaged(fmt::format("the Draco attribute {} has {} components", name, source.components));
  std::vector<V> elements(source.count);
  if (!elements.empty()) convert_to_floats(source, &elements[0].x);
  return elements;
}

}  // namespace

PrimitiveReader::PrimitiveReader(const Document& document, const tinygltf::Primitive& primitive)
    : document_(document), primitive_(primitive) {
  if (is_draco_primitive(primitive)) draco_ = decode_draco_primitive(document, primitive);
}

const DracoAttribute* PrimitiveReader::draco(const std::string& name) const {
  const auto it = draco_.attributes.find(name);
  return it == draco_.attributes.end() ? nullptr : &it->second;
}

int PrimitiveReader::accessor(const std::string& name) const {
  const auto it = primitive_.attributes.find(name);
  return it == primitive_.attributes.end() ? -1 : it->second;
}

size_t PrimitiveReader::count(const std::string& name) const {
  if (const DracoAttribute* attribute = draco(name)) return attribute->source.count;
  return accessor_count(document_, accessor(name));
}

int PrimitiveReader::components(const std::string& name) const {
  if (const DracoAttribute* attribute = draco(name)) return attribute->source.components;
  return accessor_components(document_, accessor(name));
}

std::vector<Vec2> PrimitiveReader::vec2(const std::string& name) const {
  if (const DracoAttribute* attribute = draco(name)) return convert<Vec2>(document_, attribute->source, name);
  return read_vec2(document_, accessor(name));
}

std::vector<Vec3> PrimitiveReader::vec3(const std::string& name) const {
  if (const DracoAttribute* attribute = draco(name)) return convert<Vec3>(document_, attribute->source, name);
  return read_vec3(document_, accessor(name));
}

std::vector<Vec4> PrimitiveReader::vec4(const std::string& name) const {
  if (const DracoAttribute* attribute = draco(name)) return convert<Vec4>(document_, attribute->source, name);
  return read_vec4(document_, accessor(name));
}

std::vector<uint32_t> PrimitiveReader::indices(size_t vertex_count) const {
  if (!draco_.indices.empty()) return draco_.indices;
  if (primitive_.indices >= 0) return read_indices(document_, primitive_.indices);
  std::vector<uint32_t> all(vertex_count);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

}  // namespace relume::gltf
