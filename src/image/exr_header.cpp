#include "image/exr_header.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "image/image_limits.h"
#include "relume/error.h"
#include "relume/image_io.h"

namespace relume::detail {
namespace {

/// Upper bound on decoded bytes per file byte for every compression of the format (DWA of black images comes closest).
constexpr int64_t kMaxExpansion = 1 << 16;
constexpr size_t kMaxNameLength = 255;

// Bits of the version field (OpenEXR file layout, "Version Field").
constexpr uint32_t kDeepBit = 0x800;
constexpr uint32_t kMultiPartBit = 0x1000;

/// Little-endian reads that throw Error at the end of the data.
class Reader {
 public:
  Reader(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  [[noreturn]] void fail_truncated() const {
    throw Error(fmt::format("{}: the EXR header is damaged or cut off after {} bytes; export or copy the file again",
                            name_, position_));
  }

  template <typename T>
  T read() {
    static_assert(std::endian::native == std::endian::little);
    T value;
    if (remaining() < sizeof(T)) fail_truncated();
    std::memcpy(&value, bytes_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return value;
  }

  std::string read_name() {
    std::string text;
    for (auto c = read<char>(); c != '\0'; c = read<char>()) {
      text.push_back(c);
      if (text.size() > kMaxNameLength) fail_truncated();
    }
    return text;
  }

  Reader take(size_t count) {
    if (remaining() < count) fail_truncated();
    Reader part(bytes_.subspan(position_, count), name_);
    position_ += count;
    return part;
  }

  size_t remaining() const { return bytes_.size() - position_; }

 private:
  std::span<const std::byte> bytes_;
  const std::string& name_;
  size_t position_ = 0;
};

struct Window {
  int64_t width = 0;
  int64_t height = 0;
};

/// Memory-related fields of one header.
struct Header {
  std::vector<Window> windows;  ///< data and display
  int64_t channel_count = 0;
  int64_t lines_per_chunk = 256;  ///< depends on the compression
  int64_t tile_width = 0;         ///< 0: scan lines
  int64_t tile_height = 0;
  int64_t chunk_count = 0;
};

/// Scan lines per chunk by compression number: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
int64_t lines_per_chunk(uint8_t compression) {
  constexpr std::array<int64_t, 10> kLines{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
  return compression < kLines.size() ? kLines[compression] : 256;
}

Window read_window(Reader& value) {
  const auto x_min = value.read<int32_t>();
  const auto y_min = value.read<int32_t>();
  const auto x_max = value.read<int32_t>();
  const auto y_max = value.read<int32_t>();
  return {int64_t{x_max} - x_min + 1, int64_t{y_max} - y_min + 1};
}

int64_t count_channels(Reader& value) {
  int64_t count = 0;
  while (!value.read_name().empty()) {
    value.take(16);  // type, linearity, sampling
    ++count;
  }
  return count;
}

/// Size of a value of `type` (OpenEXR file layout, "Predefined Attribute Types"), bytes; 0 if variable.
size_t value_bytes(std::string_view type) {
  constexpr std::pair<std::string_view, size_t> kBytes[] = {{"box2f", 16},
                                                            {"box2i", 16},
                                                            {"chromaticities", 32},
                                                            {"compression", 1},
                                                            {"deepImageState", 1},
                                                            {"double", 8},
                                                            {"envmap", 1},
                                                            {"float", 4},
                                                            {"int", 4},
                                                            {"keycode", 28},
                                                            {"lineOrder", 1},
                                                            {"m33d", 72},
                                                            {"m33f", 36},
                                                            {"m44d", 128},
                                                            {"m44f", 64},
                                                            {"rational", 8},
                                                            {"tiledesc", 9},
                                                            {"timecode", 8},
                                                            {"v2d", 16},
                                                            {"v2f", 8},
                                                            {"v2i", 8},
                                                            {"v3d", 24},
                                                            {"v3f", 12},
                                                            {"v3i", 12}};
  for (const auto& [name, bytes] : kBytes) {
    if (name == type) return bytes;
  }
  return 0;
}

/// Checks attributes that the library reads by sizes inside the value, not by the attribute's size.
void check_nested_sizes(const std::string& type, Reader& value) {
  if (type == "stringvector") {
    while (value.remaining() > 0) value.take(value.read<uint32_t>());
  } else if (type == "preview") {
    const auto width = value.read<uint32_t>();
    const auto height = value.read<uint32_t>();
    if (value.remaining() % 4 != 0 || uint64_t{width} * height != value.remaining() / 4) value.fail_truncated();
  } else if (type == "floatvector") {
    if (value.remaining() % 4 != 0) value.fail_truncated();
  }
}

/// Throws unless the attribute's declared size is the size of its type, which the library reads. Otherwise the library
/// would find the next attribute at another offset than check_exr_header(), with an unchecked size.
void read_attribute(const std::string& attribute, const std::string& type, Reader value, Header& header) {
  const size_t bytes = value_bytes(type);
  if (bytes != 0 && value.remaining() != bytes) value.fail_truncated();
  if (type == "box2i") {
    if (attribute == "dataWindow" || attribute == "displayWindow") header.windows.push_back(read_window(value));
  } else if (type == "chlist") {
    header.channel_count = std::max(header.channel_count, count_channels(value));
    if (value.remaining() != 0) value.fail_truncated();
  } else if (type == "compression") {
    header.lines_per_chunk = lines_per_chunk(value.read<uint8_t>());
  } else if (type == "tiledesc") {
    header.tile_width = value.read<uint32_t>();
    header.tile_height = value.read<uint32_t>();
  } else if (type == "int" && attribute == "chunkCount") {
    header.chunk_count = value.read<int32_t>();
  } else {
    check_nested_sizes(type, value);
  }
}

void check_header(const Header& header, const std::string& name, uint64_t file_bytes) {
  const int64_t pixel_bytes = 4 * std::max<int64_t>(header.channel_count, 1);
  const auto check_size = [&](int64_t width, int64_t height) {
    check_image_size(name, width, height, pixel_bytes, file_bytes, kMaxExpansion);
  };
  const int64_t max_chunks = static_cast<int64_t>(file_bytes / 8);  // each chunk has an offset in the file
  int64_t chunks = header.chunk_count;
  for (const Window& window : header.windows) {
    check_size(window.width, window.height);
    if (header.tile_width > 0 && header.tile_height > 0) {
      check_size(header.tile_width, header.tile_height);
      continue;
    }
    // The library's line buffer has the height of a chunk even if the image is smaller.
    check_size(window.width, std::min<int64_t>(header.lines_per_chunk, kMaxImageSide));
  }
  if (!header.windows.empty() && header.tile_width > 0 && header.tile_height > 0) {
    const Window& window = header.windows.front();
    chunks = std::max(chunks, ((window.width + header.tile_width - 1) / header.tile_width) *
                                  ((window.height + header.tile_height - 1) / header.tile_height));
  }
  if (chunks > max_chunks)
    throw Error(fmt::format(
        "{}: the header declares {} blocks of pixels, more than a file of {} bytes can hold; export it again", name,
        chunks, file_bytes));
}

}  // namespace

void check_exr_header(std::span<const std::byte> bytes, const std::string& name) {
  check_exr_header(bytes, name, bytes.size());
}

void check_exr_header(std::span<const std::byte> bytes, const std::string& name, uint64_t file_bytes) {
  Reader reader(bytes, name);
  if (reader.read<uint32_t>() != 20000630u) throw Error(fmt::format("{}: not an OpenEXR file; check its format", name));
  const auto version = reader.read<uint32_t>();
  if ((version & 0xffu) != 2)
    throw Error(fmt::format("{}: OpenEXR version {} is not supported; export it as version 2", name, version & 0xffu));
  if (version & kDeepBit) throw Error(fmt::format("{}: deep EXR files are not supported; export it flat", name));
  const bool multi_part = (version & kMultiPartBit) != 0;
  do {
    Header header;
    std::string attribute = reader.read_name();
    if (attribute.empty()) break;  // the list of parts ends with an empty header
    for (; !attribute.empty(); attribute = reader.read_name()) {
      const std::string type = reader.read_name();
      const auto size = reader.read<uint32_t>();
      read_attribute(attribute, type, reader.take(size), header);
    }
    check_header(header, name, file_bytes);
  } while (multi_part);
}

}  // namespace relume::detail
