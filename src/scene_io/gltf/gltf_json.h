// The JSON part of a glTF file, checked and brought into the form that tinygltf reads without harm.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace relume::gltf {

/// One element of "buffers".
struct BufferEntry {
  std::string uri;  ///< empty: the binary chunk of a .glb, or no bytes
  uint64_t byte_length = 0;
  bool is_fallback = false;  ///< EXT_meshopt_compression: holds no bytes
};

/// One element of "images".
struct ImageEntry {
  std::string name;
  std::string uri;
  int buffer_view = -1;
};

/// What prepare_json() splits a glTF document into. Buffers and images are read by us: tinygltf neither checks the
/// buffer views of images nor accepts buffers without bytes.
struct PreparedJson {
  std::string text;  ///< for tinygltf
  std::vector<BufferEntry> buffers;
  std::vector<ImageEntry> images;
  std::string scene_extras;  ///< extras.relume of the scene that is shown, as JSON; empty: none
  int no_buffer_view = 0;    ///< index that stands for "no buffer view" in the accessors of `text`
};

/// Throws Error with `place` if `json_text` is not JSON, not glTF 2, not built as glTF says, or requires an extension
/// that is not supported.
PreparedJson prepare_json(std::string_view json_text, const std::string& place);

/// Names of all extensions that the loader understands, as in extensionsUsed.
std::vector<std::string_view> supported_extensions();
/// Whether `name` is one of them.
bool is_supported_extension(std::string_view name);

}  // namespace relume::gltf
