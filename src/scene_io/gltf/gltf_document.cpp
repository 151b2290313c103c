#include "scene_io/gltf/gltf_document.h"

#include <charconv>
#include <cstring>

#include <fmt/format.h>

#include "core/parallel.h"

namespace relume::gltf {
namespace {

constexpr uint32_t kGlbMagic = 0x46546c67;   // "glTF"
constexpr uint32_t kJsonChunk = 0x4e4f534a;  // "JSON"
constexpr uint32_t kBinChunk = 0x004e4942;   // "BIN"

struct Chunks {
  std::string_view json;
  ByteSpan bin;
};

uint32_t read_u32(ByteSpan bytes, size_t offset) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

std::string_view as_text(ByteSpan bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// glTF 2.0, §4.4: a 12-byte header, then chunks of length, type and payload.
Chunks split_glb(const Document& document, ByteSpan file) {
  if (file.size() < 20) document.damaged("the file ends within its header");
  if (read_u32(file, 4) != 2)
    document.fail(fmt::format("GLB version {} is not supported; convert the file to 2", read_u32(file, 4)));
  const size_t length = read_u32(file, 8);
  if (length > file.size())
    document.damaged(fmt::format("the header states {} bytes but the file has {}", length, file.size()));
  Chunks chunks;
  size_t offset = 12;
  while (offset + 8 <= length) {
    const size_t size = read_u32(file, offset);
    const uint32_t type = read_u32(file, offset + 4);
    if (size > length - offset - 8)
      document.damaged(fmt::format("the chunk at byte {} goes beyond the end of the file", offset));
    const ByteSpan payload = file.subspan(offset + 8, size);
    if (offset == 12 && type != kJsonChunk) document.fail("the first chunk is not JSON; this is not a valid GLB file");
    if (offset == 12) {
      chunks.json = as_text(payload);
    } else if (type == kBinChunk && chunks.bin.empty()) {
      chunks.bin = payload;
    }
    offset += 8 + size;
  }
  return chunks;
}

/// First line of tinygltf's message, without its full stop: it states the problem.
std::string first_line(const std::string& text) {
  std::string line = text.substr(0, text.find('\n'));
  if (line.ends_with('.')) line.pop_back();
  return line.empty() ? "its structure cannot be read" : line;
}

void parse_model(Document& document, const std::string& json) {
  tinygltf::TinyGLTF parser;
  std::string error;
  std::string warning;
  if (json.size() > 0xffffffffu) document.fail("the JSON is larger than 4 GiB; split the file");
  bool ok = false;
  try {
    ok = parser.LoadASCIIFromString(&document.model, &error, &warning, json.data(), static_cast<unsigned>(json.size()),
                                    "", tinygltf::REQUIRE_VERSION);
  } catch (const std::exception& exception) {
    error = exception.what();
  }
  if (!ok) document.damaged(fmt::format("not valid glTF: {}", first_line(error)));
}

ByteSpan load_buffer(Document& document, const BufferEntry& entry, size_t index, ByteSpan bin) {
  ByteSpan bytes = bin;
  if (!entry.uri.empty()) {
    if (is_data_uri(entry.uri)) {
      auto decoded = decode_data_uri(entry.uri);
      if (!decoded) document.damaged(fmt::format("the data URI of buffers[{}] is malformed", index));
      document.storage.push_back(std::move(*decoded));
    } else {
      const auto file = resolve_uri(document.base_dir, percent_decode(entry.uri), document.place);
      if (const std::string reason = missing_reason(file); !reason.empty())
        document.fail(
            fmt::format("its buffer '{}' {}; put the file beside it or correct the URI", file.string(), reason));
      document.storage.push_back(read_file_bytes(file));
    }
    bytes = document.storage.back();
  } else if (entry.is_fallback || index != 0 || bin.empty()) {
    return {};  // unused, or set by an extension
  }
  if (entry.byte_length > bytes.size())
    document.damaged(
        fmt::format("buffers[{}] should have {} bytes but has {}", index, entry.byte_length, bytes.size()));
  return bytes.first(entry.byte_length);
}

void slice_views(Document& document) {
  const auto& views = document.model.bufferViews;
  document.views.resize(views.size());
  for (size_t i = 0; i < views.size(); ++i) {
    if (static_cast<int>(i) == document.no_buffer_view || is_meshopt_view(views[i])) continue;
    const auto& view = views[i];
    if (view.buffer < 0 || static_cast<size_t>(view.buffer) >= document.buffers.size())
      document.damaged(fmt::format("bufferViews[{}] refers to missing buffer {}", i, view.buffer));
    const ByteSpan buffer = document.buffers[static_cast<size_t>(view.buffer)];
    if (buffer.empty()) continue;  // maybe nothing uses the view: see view_problem()
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
      document.damaged(fmt::format("bufferViews[{}] ({} bytes at {}) goes beyond its buffer of {} bytes", i,
                                   view.byteLength, view.byteOffset, buffer.size()));
    document.views[i] = buffer.subspan(view.byteOffset, view.byteLength);
  }
}

void decompress_views(Document& document) {
  std::vector<size_t> compressed;
  for (size_t i = 0; i < document.model.bufferViews.size(); ++i) {
    if (is_meshopt_view(document.model.bufferViews[i])) compressed.push_back(i);
  }
  std::vector<Bytes> decoded(compressed.size());
  parallel_for(compressed.size(), [&](size_t k) { decoded[k] = decode_meshopt_view(document, compressed[k]); });
  for (size_t k = 0; k < compressed.size(); ++k) {
    document.storage.push_back(std::move(decoded[k]));
    document.views[compressed[k]] = document.storage.back();
  }
}

/// glTF 2.0, §3.2: files name the oldest version that can display them; later minor versions only add features.
void warn_of_version(Document& document) {
  const std::string& text = document.model.asset.minVersion;
  int major = 0;
  int minor = 0;
  const char* const end = text.data() + text.size();
  const auto [dot, failure] = std::from_chars(text.data(), end, major);
  if (failure != std::errc{}) return;
  if (dot != end) std::from_chars(dot + 1, end, minor);
  if (major > 2 || (major == 2 && minor > 0))
    document.warnings.add(
        fmt::format("the file requires glTF {}, but relume supports 2.0; parts may be missing", text));
}

void warn_of_extensions(Document& document) {
  for (const std::string& name : document.model.extensionsUsed) {
    if (!is_supported_extension(name))
      document.warnings.add(fmt::format("the extension {} is not supported and is ignored", name));
  }
}

}  // namespace

std::string view_problem(const Document& document, size_t view) {
  const tinygltf::BufferView& source = document.model.bufferViews[view];
  const bool has_own_bytes = is_meshopt_view(source) || static_cast<int>(view) == document.no_buffer_view;
  if (has_own_bytes || !document.buffers[static_cast<size_t>(source.buffer)].empty()) return {};
  return fmt::format("buffers[{}] has neither a URI nor a binary chunk, but bufferViews[{}] needs it", source.buffer,
                     view);
}

ByteSpan view_bytes(const Document& document, size_t view) {
  if (const std::string problem = view_problem(document, view); !problem.empty()) document.damaged(problem);
  return document.views[view];
}

void read_document(ByteSpan file, const std::filesystem::path& base_dir, Document& document) {
  document.base_dir = base_dir;
  Chunks chunks;
  if (file.size() >= 4 && read_u32(file, 0) == kGlbMagic) {
    chunks = split_glb(document, file);
  } else {
    chunks.json = as_text(file);
  }
  PreparedJson prepared = prepare_json(chunks.json, document.place);
  parse_model(document, prepared.text);
  document.images = std::move(prepared.images);
  document.scene_extras = std::move(prepared.scene_extras);
  document.no_buffer_view = prepared.no_buffer_view;
  document.storage.reserve(prepared.buffers.size() + document.model.bufferViews.size());
  for (size_t i = 0; i < prepared.buffers.size(); ++i)
    document.buffers.push_back(load_buffer(document, prepared.buffers[i], i, chunks.bin));
  slice_views(document);
  decompress_views(document);
  warn_of_version(document);
  warn_of_extensions(document);
}

}  // namespace relume::gltf
