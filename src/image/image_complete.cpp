#include "image/image_complete.h"

#include "files/little_endian.h"

namespace relume::detail {
namespace {

/// Whether every chunk ends within the file. stb_image would first allocate memory for a damaged length.
bool is_complete_png(std::span<const std::byte> bytes) {
  constexpr size_t kSignature = 8;
  constexpr size_t kChunkHead = 8;  // length (big-endian) and type
  constexpr size_t kChecksum = 4;
  size_t offset = kSignature;
  while (offset + kChunkHead <= bytes.size()) {
    uint32_t length = 0;
    for (size_t i = 0; i < 4; ++i) length = (length << 8) | std::to_integer<uint32_t>(bytes[offset + i]);
    if (starts_with(bytes, "IEND", offset + 4)) return true;
    if (length > bytes.size() - offset - kChunkHead) return false;
    offset += kChunkHead + length + kChecksum;
  }
  return false;
}

/// End of the entropy-coded data at `offset`: the first marker that is neither a stuffed byte nor a restart.
size_t end_of_scan(std::span<const std::byte> bytes, size_t offset) {
  for (; offset + 1 < bytes.size(); ++offset) {
    const auto code = std::to_integer<unsigned>(bytes[offset + 1]);
    const bool is_marker =
        bytes[offset] == std::byte{0xff} && code != 0 && code != 0xff && (code < 0xd0 || code > 0xd7);
    if (is_marker) return offset;
  }
  return bytes.size();
}

/// ITU-T T.81, annex B: walks the segments by their lengths to the end of the image. Thumbnails lie within segments;
/// data after the end (videos of phones) are ignored.
bool is_complete_jpeg(std::span<const std::byte> bytes) {
  constexpr unsigned kEndOfImage = 0xd9;
  constexpr unsigned kStartOfScan = 0xda;
  size_t offset = 2;
  while (offset + 1 < bytes.size()) {
    const auto code = std::to_integer<unsigned>(bytes[offset + 1]);
    if (bytes[offset] != std::byte{0xff} || code == 0xff) {  // fill bytes, and bytes that decoders skip
      ++offset;
      continue;
    }
    if (code == kEndOfImage) return true;
    if (offset + 4 > bytes.size()) return false;
    offset += 2 + (std::to_integer<size_t>(bytes[offset + 2]) << 8 | std::to_integer<size_t>(bytes[offset + 3]));
    if (code == kStartOfScan) offset = end_of_scan(bytes, offset);
  }
  return false;
}

/// Truevision TGA File Format Specification 2.0: header, name, colour map, then pixels or packets of up to 128.
bool is_complete_tga(std::span<const std::byte> bytes, uint64_t pixel_count) {
  const uint64_t map_bytes =
      number_at(bytes, 1, 1) != 0 ? number_at(bytes, 5, 2) * ((number_at(bytes, 7, 1) + 7) / 8) : 0;
  const uint64_t pixel_bytes = (number_at(bytes, 16, 1) + 7) / 8;
  const bool run_length_encoded = (number_at(bytes, 2, 1) & 8) != 0;
  uint64_t end = 18 + number_at(bytes, 0, 1) + map_bytes;
  if (!run_length_encoded) return end + pixel_count * pixel_bytes <= bytes.size();
  for (uint64_t pixels = 0; pixels < pixel_count;) {
    if (end >= bytes.size()) return false;
    const uint64_t head = number_at(bytes, end, 1);
    const uint64_t count = (head & 127) + 1;
    end += 1 + (head & 128 ? 1 : count) * pixel_bytes;
    pixels += count;
  }
  return end <= bytes.size();
}

}  // namespace

bool starts_with(std::span<const std::byte> bytes, std::string_view magic, size_t offset) {
  if (bytes.size() < offset + magic.size()) return false;
  for (size_t i = 0; i < magic.size(); ++i) {
    if (static_cast<char>(bytes[offset + i]) != magic[i]) return false;
  }
  return true;
}

bool is_complete(std::span<const std::byte> bytes, ImageFormat format, uint64_t pixel_count) {
  switch (format) {
    case ImageFormat::png: return is_complete_png(bytes);
    case ImageFormat::jpeg: return is_complete_jpeg(bytes);
    case ImageFormat::tga: return is_complete_tga(bytes, pixel_count);
    default: return true;
  }
}

}  // namespace relume::detail
