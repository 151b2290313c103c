#include "image/ktx2/ktx2.h"

#include <string_view>

#include <fmt/format.h>
#include <zstd.h>

#include "files/little_endian.h"
#include "image/image_complete.h"
#include "image/image_limits.h"
#include "image/ktx2/etc1s.h"
#include "image/ktx2/ktx2_error.h"
#include "image/ktx2/ktx2_header.h"
#include "image/ktx2/uastc.h"

namespace relume::detail {
namespace {

using Span = std::span<const std::byte>;

/// Upper bound on decoded bytes per file byte, over all encoders.
int64_t max_expansion(const Ktx2Header& header) {
  constexpr int64_t kPerByte = 4;          // R alone, or UASTC, becomes RGBA
  constexpr int64_t kZstandard = 1 << 15;  // blocks of 128 KiB that repeat a byte take 4 bytes
  constexpr int64_t kBasisLz = 1 << 20;    // runs of blocks have any length
  switch (header.supercompression) {
    case Ktx2Supercompression::none: return kPerByte;
    case Ktx2Supercompression::basis_lz: return kBasisLz;
    case Ktx2Supercompression::zstandard: return kPerByte * kZstandard;
  }
  return kPerByte;
}

/// Level 0 without supercompression; `storage` holds it if the file does not.
Span inflate(const Ktx2Header& header, uint64_t size, std::vector<std::byte>& storage, const std::string& name) {
  if (header.uncompressed_bytes != size)
    fail_damaged_ktx2(name, fmt::format("its first level has {} bytes, not {}", header.uncompressed_bytes, size));
  if (header.supercompression == Ktx2Supercompression::none) {
    if (header.data.size() < size) fail_cut_off_ktx2(name);
    return header.data.first(size);
  }
  storage.resize(size);
  const size_t written = ZSTD_decompress(storage.data(), storage.size(), header.data.data(), header.data.size());
  if (ZSTD_isError(written)) fail_damaged_ktx2(name, fmt::format("Zstandard: {}", ZSTD_getErrorName(written)));
  if (written != size) fail_cut_off_ktx2(name);
  return storage;
}

std::vector<uint8_t> decode_plain(const Ktx2Header& header, const std::string& name) {
  const auto texels = static_cast<uint64_t>(header.width * header.height);
  std::vector<std::byte> storage;
  const Span data = inflate(header, texels * header.plain_channels, storage, name);
  std::vector<uint8_t> rgba(4 * texels);
  for (uint64_t i = 0; i < texels; ++i) {
    rgba[4 * i + 3] = 255;
    for (size_t c = 0; c < header.plain_channels; ++c)
      rgba[4 * i + c] = std::to_integer<uint8_t>(data[i * header.plain_channels + c]);
  }
  return rgba;
}

std::vector<uint8_t> decode_uastc_level(const Ktx2Header& header, const std::string& name) {
  const auto blocks = static_cast<uint64_t>((header.width + 3) / 4 * ((header.height + 3) / 4));
  std::vector<std::byte> storage;
  const Span data = inflate(header, blocks * kUastcBlockBytes, storage, name);
  return decode_uastc(data, static_cast<size_t>(header.width), static_cast<size_t>(header.height), header.is_srgb);
}

/// A slice of level 0, located by `field` of the image description.
Span slice_at(Span data, Span description, size_t field, const std::string& name) {
  const uint64_t offset = number_at(description, field, 4);
  const uint64_t size = number_at(description, field + 4, 4);
  if (size == 0) fail_damaged_ktx2(name, "a slice has no bytes");
  if (offset > data.size() || size > data.size() - offset) fail_damaged_ktx2(name, "a slice ends beyond its level");
  return data.subspan(offset, size);
}

/// Decodes BasisLZ's global data before the slices of level 0 (KTX specification, appendix "BasisLZ Global Data").
Etc1sGlobalData read_global_data(const Ktx2Header& header, const std::string& name) {
  constexpr uint64_t kHead = 20;
  constexpr uint64_t kImage = 20;
  const Span data = header.global_data;
  uint64_t at = kHead + kImage * header.level_count;
  if (data.size() < at) fail_damaged_ktx2(name, "BasisLZ's global data end early");
  const auto section = [&](size_t field) {
    const uint64_t size = number_at(data, field, 4);
    if (size > data.size() - at) fail_damaged_ktx2(name, "BasisLZ's global data end early");
    at += size;
    return data.subspan(at - size, size);
  };
  const Span endpoints = section(4);
  const Span selectors = section(8);
  const Span tables = section(12);
  return {read_etc1s_endpoints(endpoints, number_at(data, 0, 2), name),
          read_etc1s_selectors(selectors, number_at(data, 2, 2), name), read_etc1s_tables(tables, name)};
}

std::vector<uint8_t> decode_etc1s_level(const Ktx2Header& header, const std::string& name) {
  constexpr uint64_t kFirstImage = 20;
  constexpr uint32_t kPredictedFrame = 2;
  const Etc1sGlobalData global = read_global_data(header, name);
  const Span image = header.global_data.subspan(kFirstImage);
  if ((number_at(image, 0, 4) & kPredictedFrame) != 0) fail_unsupported_ktx2(name, "a P-frame (video)");
  const auto width = static_cast<size_t>(header.width);
  const auto height = static_cast<size_t>(header.height);
  const std::vector<uint8_t> rgb =
      decode_etc1s_slice(slice_at(header.data, image, 4, name), width, height, global, name);
  std::vector<uint8_t> rgba(4 * width * height, 255);
  for (size_t i = 0; i < width * height; ++i) {
    for (size_t c = 0; c < 3; ++c) rgba[4 * i + c] = rgb[3 * i + c];
  }
  if (header.slices == 1) return rgba;
  const std::vector<uint8_t> alpha =
      decode_etc1s_slice(slice_at(header.data, image, 12, name), width, height, global, name);
  for (size_t i = 0; i < width * height; ++i) rgba[4 * i + 3] = alpha[3 * i];
  return rgba;
}

std::vector<uint8_t> decode_level(const Ktx2Header& header, const std::string& name) {
  switch (header.encoding) {
    case Ktx2Encoding::plain: return decode_plain(header, name);
    case Ktx2Encoding::etc1s: return decode_etc1s_level(header, name);
    case Ktx2Encoding::uastc: return decode_uastc_level(header, name);
  }
  return {};
}

/// Sets R, G, B and A of all pixels to the sources named by `sources`: channels, 0 or 1.
void swizzle(const std::string& sources, std::vector<uint8_t>& rgba) {
  if (sources == "rgba") return;
  constexpr std::string_view kNames = "rgba01";
  for (size_t i = 0; i < rgba.size(); i += 4) {
    const uint8_t values[] = {rgba[i], rgba[i + 1], rgba[i + 2], rgba[i + 3], 0, 255};
    for (size_t c = 0; c < 4; ++c) rgba[i + c] = values[kNames.find(sources[c])];
  }
}

}  // namespace

bool is_ktx2(Span bytes) {
  using namespace std::string_view_literals;
  return starts_with(bytes, "\xabKTX 20\xbb\r\n\x1a\n"sv);
}

Ktx2Image decode_ktx2(Span bytes, const std::string& name) {
  constexpr int64_t kPixelBytes = 4;
  const Ktx2Header header = read_ktx2_header(bytes, name);
  check_image_size(name, header.width, header.height, kPixelBytes, bytes.size(), max_expansion(header));
  Ktx2Image image;
  image.width = static_cast<int>(header.width);
  image.height = static_cast<int>(header.height);
  image.is_srgb = header.is_srgb;
  image.has_alpha = header.swizzle[3] == 'a' ? header.has_alpha : header.swizzle[3] != '1';
  image.rgba8 = decode_level(header, name);
  swizzle(header.channels, image.rgba8);
  swizzle(header.swizzle, image.rgba8);
  return image;
}

}  // namespace relume::detail
