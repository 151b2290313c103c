// A glTF file in memory: tinygltf's model plus the checked bytes of its buffers, views and images.
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

/// Neither copyable nor movable: `views` point into other members.
struct Document {
  explicit Document(std::string place_) : place(std::move(place_)), warnings(place) {}
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  /// Throws Error "place: problem".
  [[noreturn]] void fail(const std::string& problem) const { throw Error(place + ": " + problem); }
  /// Throws Error for contradictory data.
  [[noreturn]] void damaged(const std::string& problem) const {
    fail(problem + "; the file is damaged, export or copy it again");
  }

  std::string place;
  std::filesystem::path base_dir;
  Warnings warnings;
  tinygltf::Model model;          ///< without buffers and images
  std::vector<ByteSpan> buffers;  ///< empty without bytes, as for a fallback buffer
  std::vector<ByteSpan> views;    ///< per buffer view, decompressed; in range; empty if the buffer is
  std::vector<ImageEntry> images;
  std::string scene_extras;    ///< see PreparedJson
  int no_buffer_view = 0;      ///< buffer view index of accessors without one
  std::vector<Bytes> storage;  ///< data of spans outside the file's bytes
};

/// Fills `document` from the bytes of a .gltf or .glb file, which must outlive it. Throws Error.
void read_document(ByteSpan file, const std::filesystem::path& base_dir, Document& document);

/// Reason why a view of Document::views cannot be used: its buffer has no bytes. Empty if it can. Such views are valid
/// if nothing uses them, or only an extension that relume ignores.
std::string view_problem(const Document& document, size_t view);
/// Bytes of a view of Document::views. Throws Error with view_problem().
ByteSpan view_bytes(const Document& document, size_t view);

/// Decompresses a view with EXT_meshopt_compression. Defined in gltf_meshopt.cpp.
Bytes decode_meshopt_view(const Document& document, size_t view);
bool is_meshopt_view(const tinygltf::BufferView& view);

}  // namespace relume::gltf
