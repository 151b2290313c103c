// A glTF file in memory: tinygltf's model plus the bytes of its buffers, views and images, all of them checked.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include "files/bytes.h"
#include "relume/error.h"
#include "scene_io/gltf/gltf_json.h"
#include "scene_io/warnings.h"

namespace relume::gltf {

using ByteSpan = std::span<const std::byte>;

/// Move-only in effect: `views` point into the other members.
struct Document {
  explicit Document(std::string place_) : place(std::move(place_)), warnings(place) {}
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  /// Throws Error "place: problem".
  [[noreturn]] void fail(const std::string& problem) const { throw Error(place + ": " + problem); }
  /// The same for data that contradict themselves.
  [[noreturn]] void damaged(const std::string& problem) const {
    fail(problem + "; the file is damaged, export or copy it again");
  }

  std::string place;
  std::filesystem::path base_dir;
  Warnings warnings;
  tinygltf::Model model;          ///< without buffers and images
  std::vector<ByteSpan> buffers;  ///< empty: without bytes, as a fallback buffer
  std::vector<ByteSpan> views;    ///< by buffer view, decompressed; in range
  std::vector<ImageEntry> images;
  std::string scene_extras;    ///< see PreparedJson
  int no_buffer_view = 0;      ///< an accessor with this buffer view has none
  std::vector<Bytes> storage;  ///< what spans point into, besides the file itself
};

/// Fills `document` from a .gltf or .glb file in memory, which must outlive it. Throws Error.
void read_document(ByteSpan file, const std::filesystem::path& base_dir, Document& document);

/// Decompresses the views with EXT_meshopt_compression; declared here, defined in gltf_meshopt.cpp.
Bytes decode_meshopt_view(const Document& document, size_t view);
bool is_meshopt_view(const tinygltf::BufferView& view);

}  // namespace relume::gltf
