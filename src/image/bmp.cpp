// Microsoft, "Bitmap Storage" and [MS-WMF] 2.2.2; OS/2 2.0 Presentation Manager Reference, "Bitmap File Format".
#include "image/bmp.h"

#include <algorithm>
#include <array>
#include <bit>

#include <fmt/format.h>

#include "files/little_endian.h"
#include "image/image_limits.h"
#include "relume/error.h"

namespace relume::detail {
namespace {

using Span = std::span<const std::byte>;

constexpr uint64_t kFileHeader = 14;
constexpr uint64_t kCoreHeader = 12;  ///< header of OS/2 1 and Windows 2
constexpr uint64_t kInfoHeader = 40;
constexpr uint64_t kOs2Header = 64;
constexpr uint64_t kMasksAt = kFileHeader + kInfoHeader;  ///< after BITMAPINFOHEADER, or part of a later header

enum Compression : uint32_t { kUncompressed = 0, kRle8 = 1, kRle4 = 2, kMasks = 3, kMasksWithAlpha = 6 };

struct Header {
  uint64_t size = 0;  ///< size without the file header
  int64_t width = 0;
  int64_t height = 0;
  bool from_above = false;  ///< whether the first row is the top row
  uint32_t depth = 0;       ///< bits per pixel
  uint32_t compression = kUncompressed;
  std::array<uint32_t, 4> masks{};  ///< masks of R, G, B, A for depths of 16 and 32
  bool alpha_may_be_unused = false;
  uint64_t pixels_at = 0;
};

[[noreturn]] void damaged(const std::string& name, const std::string& problem) {
  throw Error(fmt::format("{}: damaged image ({}); export or copy it again", name, problem));
}

[[noreturn]] void cut_off(const std::string& name) {
  throw Error(fmt::format("{}: the image is cut off; export or copy it again", name));
}

[[noreturn]] void unsupported(const std::string& name, const std::string& feature) {
  throw Error(fmt::format("{}: BMP images with {} are not supported; save it as PNG", name, feature));
}

void check_compression(const Header& header, const std::string& name) {
  const bool is_os2 = header.size == kOs2Header;
  const uint32_t compression = header.compression;
  const uint32_t depth = header.depth;
  if (is_os2 && compression == 3) unsupported(name, "Huffman compression");
  if (is_os2 && compression == 4) unsupported(name, "run lengths of 24-bit pixels");
  if (compression == 4) unsupported(name, "a JPEG inside");
  if (compression == 5) unsupported(name, "a PNG inside");
  if (compression > kMasksWithAlpha) unsupported(name, fmt::format("compression {}", compression));
  if (depth != 1 && depth != 4 && depth != 8 && depth != 16 && depth != 24 && depth != 32)
    unsupported(name, fmt::format("{} bits per pixel", depth));
  const bool fits = compression == kRle8   ? depth == 8
                    : compression == kRle4 ? depth == 4
                                           : compression == kUncompressed || depth == 16 || depth == 32;
  if (!fits) damaged(name, fmt::format("compression {} with {} bits per pixel", compression, depth));
}

void read_masks(Span bytes, Header& header, const std::string& name) {
  if (header.compression == kMasks || header.compression == kMasksWithAlpha) {
    constexpr uint64_t kHeaderWithAlpha = 56;
    const bool has_alpha = header.size >= kHeaderWithAlpha || header.compression == kMasksWithAlpha;
    for (size_t c = 0; c < (has_alpha ? 4u : 3u); ++c)
      header.masks[c] = static_cast<uint32_t>(number_at(bytes, kMasksAt + 4 * c, 4));
    if (header.masks[0] == 0 || header.masks[1] == 0 || header.masks[2] == 0) damaged(name, "a colour has no mask");
  } else if (header.depth == 16) {
    header.masks = {0x7c00, 0x3e0, 0x1f, 0};
  } else if (header.depth == 32) {
    header.masks = {0xff0000, 0xff00, 0xff, 0xff000000};
    header.alpha_may_be_unused = true;
  }
}

Header read_header(Span bytes, const std::string& name) {
  constexpr uint64_t kArray = 0x4142;  // "BA"
  if (bytes.size() >= 2 && number_at(bytes, 0, 2) == kArray) unsupported(name, "an OS/2 array of bitmaps");
  if (bytes.size() < kFileHeader + kCoreHeader) cut_off(name);
  Header header;
  header.pixels_at = number_at(bytes, 10, 4);
  header.size = number_at(bytes, kFileHeader, 4);
  const bool is_core = header.size == kCoreHeader;
  if (!is_core && (header.size < 16 || header.size > 124))
    unsupported(name, fmt::format("a header of {} bytes", header.size));
  if (header.pixels_at < kFileHeader + header.size) damaged(name, "its pixels start within the header");
  // OS/2 allows truncated headers; missing fields are 0.
  if (bytes.size() < kFileHeader + header.size) cut_off(name);
  const Span fields = bytes.first(kFileHeader + header.size);
  const uint64_t height = number_at(fields, is_core ? 20 : 22, is_core ? 2 : 4);
  header.width =
      is_core ? static_cast<int64_t>(number_at(fields, 18, 2)) : static_cast<int32_t>(number_at(fields, 18, 4));
  header.from_above = !is_core && static_cast<int32_t>(height) < 0;
  header.height = header.from_above ? -int64_t{static_cast<int32_t>(height)} : static_cast<int64_t>(height);
  header.depth = static_cast<uint32_t>(number_at(fields, is_core ? 24 : 28, 2));
  header.compression = is_core ? kUncompressed : static_cast<uint32_t>(number_at(fields, 30, 4));
  check_compression(header, name);
  read_masks(bytes, header, name);
  return header;
}

/// Consecutive uncompressed rows.
class Rows {
 public:
  Rows(Span bytes, const Header& header, const std::string& name)
      : bytes_(bytes), header_(header), stride_((static_cast<uint64_t>(header.width) * header.depth + 31) / 32 * 4) {
    if (header.pixels_at + stride_ * static_cast<uint64_t>(header.height) > bytes.size()) cut_off(name);
  }

  /// Stored value of a pixel of a row.
  uint32_t at(uint64_t x, uint64_t row) const {
    const uint64_t bit = x * header_.depth;
    const size_t byte = header_.pixels_at + row * stride_ + bit / 8;
    if (header_.depth >= 8) return static_cast<uint32_t>(number_at(bytes_, byte, header_.depth / 8));
    const uint64_t value = number_at(bytes_, byte, 1) >> (8 - header_.depth - bit % 8);
    return static_cast<uint32_t>(value & ((1u << header_.depth) - 1));
  }

 private:
  Span bytes_;
  const Header& header_;
  uint64_t stride_;
};

/// Expands RLE4 and RLE8: pairs of a count and a value, or of 0 and a command. Skipped pixels get colour 0.
class RunLengths {
 public:
  RunLengths(Span bytes, const Header& header, const std::string& name)
      : bytes_(bytes), header_(header), name_(name), at_(header.pixels_at) {
    indices_.resize(static_cast<size_t>(header.width * header.height));
  }

  std::vector<uint8_t> expand() {
    constexpr uint32_t kEndOfRow = 0;
    constexpr uint32_t kEnd = 1;
    constexpr uint32_t kMove = 2;
    while (y_ < header_.height && !ends_complete()) {
      const uint32_t count = next();
      const uint32_t value = next();
      if (count > 0) {
        for (uint32_t i = 0; i < count; ++i) append(header_.depth == 8 ? value : nibble(value, i));
      } else if (value == kEndOfRow) {
        x_ = 0;
        ++y_;
      } else if (value == kEnd) {
        break;
      } else if (value == kMove) {
        x_ += next();
        y_ += next();
      } else {
        copy(value);
      }
    }
    return std::move(indices_);
  }

 private:
  /// Whether the data end after the last pixel, without the end marker.
  bool ends_complete() const { return y_ + 1 == header_.height && x_ >= header_.width && at_ + 2 > bytes_.size(); }

  static uint32_t nibble(uint32_t byte, uint32_t i) { return i % 2 == 0 ? byte >> 4 : byte & 15; }

  uint32_t next() {
    if (at_ >= bytes_.size()) cut_off(name_);
    return std::to_integer<uint32_t>(bytes_[at_++]);
  }

  void append(uint32_t index) {
    if (x_ < header_.width) indices_[static_cast<size_t>(y_ * header_.width + x_++)] = static_cast<uint8_t>(index);
  }

  /// Copies `count` literal pixels, padded to 16 bits.
  void copy(uint32_t count) {
    const uint64_t begin = at_;
    uint32_t byte = 0;
    for (uint32_t i = 0; i < count; ++i) {
      if (header_.depth == 8 || i % 2 == 0) byte = next();
      append(header_.depth == 8 ? byte : nibble(byte, i));
    }
    if ((at_ - begin) % 2 != 0) next();
  }

  Span bytes_;
  const Header& header_;
  const std::string& name_;
  uint64_t at_;
  int64_t x_ = 0;
  int64_t y_ = 0;
  std::vector<uint8_t> indices_;
};

/// Converts a channel of 1 to 32 bits to 8 bits; replicates the bits of narrow channels.
uint8_t channel(uint32_t pixel, uint32_t mask) {
  const int shift = std::countr_zero(mask);
  const int bits = std::bit_width(mask) - shift;
  const uint32_t value = (pixel & mask) >> shift;
  if (bits > 8) return static_cast<uint8_t>(value >> (bits - 8));
  uint32_t result = value << (8 - bits);
  for (int known = bits; known < 8; known *= 2) result |= result >> known;
  return static_cast<uint8_t>(result);
}

using Color = std::array<uint8_t, 4>;

Color color_of(uint32_t pixel, const Header& header) {
  if (header.depth == 24)
    return {static_cast<uint8_t>(pixel >> 16), static_cast<uint8_t>(pixel >> 8), static_cast<uint8_t>(pixel), 255};
  Color color = {0, 0, 0, 255};
  for (size_t c = 0; c < 4; ++c) {
    if (header.masks[c] != 0) color[c] = channel(pixel, header.masks[c]);
  }
  return color;
}

/// Reads blue, green, red and, except after a core header, an unused byte per colour.
std::vector<Color> read_palette(Span bytes, const Header& header) {
  const uint64_t entry = header.size == kCoreHeader ? 3 : 4;
  const uint64_t begin = kFileHeader + header.size;
  const uint64_t end = std::min<uint64_t>(header.pixels_at, bytes.size());
  const uint64_t count = end > begin ? std::min((end - begin) / entry, uint64_t{1} << header.depth) : 0;
  std::vector<Color> palette(count);
  for (uint64_t i = 0; i < count; ++i) {
    for (uint64_t c = 0; c < 3; ++c)
      palette[i][c] = static_cast<uint8_t>(number_at(bytes, begin + i * entry + 2 - c, 1));
    palette[i][3] = 255;
  }
  return palette;
}

/// Colours of all pixels, row by row in stored order.
std::vector<Color> read_colors(Span bytes, const Header& header, const std::string& name) {
  const auto width = static_cast<uint64_t>(header.width);
  std::vector<Color> colors(static_cast<size_t>(header.width * header.height));
  if (header.depth > 8) {
    const Rows rows(bytes, header, name);
    for (uint64_t i = 0; i < colors.size(); ++i) colors[i] = color_of(rows.at(i % width, i / width), header);
    return colors;
  }
  std::vector<uint8_t> indices;
  if (header.compression == kUncompressed) {
    const Rows rows(bytes, header, name);
    indices.resize(colors.size());
    for (uint64_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<uint8_t>(rows.at(i % width, i / width));
  } else {
    indices = RunLengths(bytes, header, name).expand();
  }
  const std::vector<Color> palette = read_palette(bytes, header);
  for (size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] >= palette.size())
      damaged(name, fmt::format("colour {} of a palette of {}", indices[i], palette.size()));
    colors[i] = palette[indices[i]];
  }
  return colors;
}

}  // namespace

ImageSize bmp_size(Span bytes, const std::string& name) {
  const Header header = read_header(bytes, name);
  return {header.width, header.height};
}

DecodedPixels decode_bmp(Span bytes, const std::string& name) {
  constexpr int64_t kPixelBytes = 4;
  constexpr int64_t kMaxPixelsPerByte = 128;  // runs of at most 255 in two bytes
  const Header header = read_header(bytes, name);
  check_image_size(name, header.width, header.height, kPixelBytes, bytes.size(), kPixelBytes * kMaxPixelsPerByte);
  const std::vector<Color> colors = read_colors(bytes, header, name);
  const bool opaque = header.alpha_may_be_unused &&
                      std::all_of(colors.begin(), colors.end(), [](const Color& color) { return color[3] == 0; });
  DecodedPixels result;
  result.width = static_cast<int>(header.width);
  result.height = static_cast<int>(header.height);
  result.rgba8.reserve(4 * colors.size());
  for (int64_t y = 0; y < header.height; ++y) {
    const int64_t row = header.from_above ? y : header.height - 1 - y;
    for (int64_t x = 0; x < header.width; ++x) {
      Color color = colors[static_cast<size_t>(row * header.width + x)];
      if (opaque) color[3] = 255;
      result.rgba8.insert(result.rgba8.end(), color.begin(), color.end());
    }
  }
  return result;
}

}  // namespace relume::detail
