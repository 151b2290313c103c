// EXT_meshopt_compression: https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor/EXT_meshopt_compression
#include <limits>

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "scene_io/gltf/gltf_document.h"
#include "scene_io/gltf/gltf_value.h"

namespace relume::gltf {
namespace {

constexpr const char* kExtension = "EXT_meshopt_compression";

struct CompressedView {
  ByteSpan data;
  size_t count = 0;
  size_t stride = 0;
  std::string mode;
  std::string filter;
};

size_t size_member(const Document& document, const tinygltf::Value& extension, const char* key, size_t view) {
  const double value = number_member(extension, key, 0);
  // Doubles represent integers exactly up to 2^53, well above any buffer size.
  if (!(value >= 0 && value <= 9e15))
    document.damaged(fmt::format("bufferViews[{}]: {} of {} is out of range", view, key, kExtension));
  return static_cast<size_t>(value);
}

CompressedView read_extension(const Document& document, size_t index) {
  const auto& extension = document.model.bufferViews[index].extensions.at(kExtension);
  const size_t buffer = size_member(document, extension, "buffer", index);
  const size_t offset = size_member(document, extension, "byteOffset", index);
  const size_t length = size_member(document, extension, "byteLength", index);
  if (buffer >= document.buffers.size())
    document.damaged(fmt::format("bufferViews[{}] refers to missing buffer {}", index, buffer));
  const ByteSpan bytes = document.buffers[buffer];
  if (offset > bytes.size() || length > bytes.size() - offset)
    document.damaged(
        fmt::format("the compressed bufferViews[{}] goes beyond its buffer of {} bytes", index, bytes.size()));
  CompressedView view;
  view.data = bytes.subspan(offset, length);
  view.count = size_member(document, extension, "count", index);
  view.stride = size_member(document, extension, "byteStride", index);
  view.mode = string_member(extension, "mode");
  view.filter = string_member(extension, "filter");
  return view;
}

/// Checks the values that the decoders trust.
void check_layout(const Document& document, const CompressedView& view, size_t index) {
  const bool is_vertex = view.mode == "ATTRIBUTES";
  const bool is_index = view.mode == "TRIANGLES" || view.mode == "INDICES";
  if (!is_vertex && !is_index)
    document.damaged(fmt::format("bufferViews[{}]: unknown compression mode '{}'", index, view.mode));
  const bool stride_ok =
      is_vertex ? view.stride > 0 && view.stride <= 256 && view.stride % 4 == 0 : view.stride == 2 || view.stride == 4;
  if (!stride_ok)
    document.damaged(
        fmt::format("bufferViews[{}]: byte stride {} does not suit mode {}", index, view.stride, view.mode));
  if (view.mode == "TRIANGLES" && view.count % 3 != 0)
    document.damaged(fmt::format("bufferViews[{}]: {} indices are not whole triangles", index, view.count));
  const bool filter_ok = view.filter.empty() || view.filter == "NONE" ||
                         (view.filter == "OCTAHEDRAL" && (view.stride == 4 || view.stride == 8)) ||
                         (view.filter == "QUATERNION" && view.stride == 8) || view.filter == "EXPONENTIAL";
  if (!filter_ok)
    document.damaged(
        fmt::format("bufferViews[{}]: filter '{}' does not suit byte stride {}", index, view.filter, view.stride));
  // No mode exceeds a ratio of 64: vertices take at least 2 bits per 16 bytes of a column, triangles one byte.
  if (view.count > view.data.size() * 64 / view.stride)
    document.damaged(fmt::format("bufferViews[{}]: {} elements cannot come from {} compressed bytes", index, view.count,
                                 view.data.size()));
}

}  // namespace

bool is_meshopt_view(const tinygltf::BufferView& view) { return view.extensions.contains(kExtension); }

Bytes decode_meshopt_view(const Document& document, size_t index) {
  const CompressedView view = read_extension(document, index);
  check_layout(document, view, index);
  Bytes decoded(view.count * view.stride);
  const auto* source = reinterpret_cast<const unsigned char*>(view.data.data());
  int failed = 0;
  if (view.mode == "ATTRIBUTES") {
    failed = meshopt_decodeVertexBuffer(decoded.data(), view.count, view.stride, source, view.data.size());
  } else if (view.mode == "TRIANGLES") {
    failed = meshopt_decodeIndexBuffer(decoded.data(), view.count, view.stride, source, view.data.size());
  } else {
    failed = meshopt_decodeIndexSequence(decoded.data(), view.count, view.stride, source, view.data.size());
  }
  if (failed != 0) document.damaged(fmt::format("the compressed data of bufferViews[{}] is damaged", index));
  if (view.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(decoded.data(), view.count, view.stride);
  if (view.filter == "QUATERNION") meshopt_decodeFilterQuat(decoded.data(), view.count, view.stride);
  if (view.filter == "EXPONENTIAL") meshopt_decodeFilterExp(decoded.data(), view.count, view.stride);
  return decoded;
}

}  // namespace relume::gltf
