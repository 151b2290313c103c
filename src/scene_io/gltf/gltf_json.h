// Checks the JSON part of a glTF file and converts it for tinygltf.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace relume::gltf {

/// An element of "buffers".
struct BufferEntry {
  std::string uri;  ///< empty: the binary chunk of a .glb, or no bytes
  uint64_t byte_length = 0;
  bool is_fallback = false;  ///< EXT_meshopt_compression: holds no bytes
};

/// An element of "images".
struct ImageEntry {
  std::string name;
  std::string uri;
  int buffer_view = -1;
};

/// Result of prepare_json(). Buffers and images are read separately: tinygltf does not check the buffer views of images
/// and rejects buffers without bytes.
struct PreparedJson {
  std::string text;  ///< document for tinygltf
  std::vector<BufferEntry> buffers;
  std::vector<ImageEntry> images;
  std::string scene_extras;  ///< extras.relume of the displayed scene, as JSON; empty: none
  int no_buffer_view = 0;    ///< index meaning "no buffer view" in the accessors of `text`
};

/// Splits and checks a document. Throws Error with `place` if `json_text` is not JSON, not glTF 2, not structured as
/// glTF specifies, or requires an unsupported extension.
PreparedJson prepare_json(std::string_view json_text, const std::string& place);

/// Names of all extensions that the loader supports, as in extensionsUsed.
std::vector<std::string_view> supported_extensions();
/// Whether `name` is a supported extension.
bool is_supported_extension(std::string_view name);

}  // namespace relume::gltf
