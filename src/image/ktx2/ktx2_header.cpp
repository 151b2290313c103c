// KTX File Format Specification 2.0; Khronos Data Format Specification 1.4.
#include "image/ktx2/ktx2_header.h"

#include <algorithm>
#include <bit>
#include <string_view>

#include <fmt/format.h>

#include "files/little_endian.h"
#include "image/ktx2/ktx2.h"
#include "image/ktx2/ktx2_error.h"

namespace relume::detail {
namespace {

using Span = std::span<const std::byte>;

constexpr uint64_t kFixedBytes = 80;  ///< size before the level index
constexpr uint64_t kLevelBytes = 24;

/// Red and green of two-channel textures, which store green as alpha.
constexpr const char* kRedAndAlpha = "ra01";

/// Part of the file. Throws Error if it ends beyond the file.
Span part(Span bytes, uint64_t offset, uint64_t size, const std::string& name) {
  if (offset > bytes.size() || size > bytes.size() - offset) fail_cut_off_ktx2(name);
  return bytes.subspan(offset, size);
}

uint32_t word_at(Span bytes, size_t offset) { return static_cast<uint32_t>(number_at(bytes, offset, 4)); }

/// Reads the dimensions. Throws Error unless the texture is one 2D image with levels.
void read_shape(Span bytes, Ktx2Header& header, const std::string& name) {
  header.width = word_at(bytes, 20);
  header.height = word_at(bytes, 24);
  const uint32_t depth = word_at(bytes, 28);
  const uint32_t layers = word_at(bytes, 32);
  const uint32_t faces = word_at(bytes, 36);
  const uint32_t levels = word_at(bytes, 40);
  if (depth > 0) fail_unsupported_ktx2(name, fmt::format("pixelDepth {} (3D textures)", depth));
  if (layers > 0) fail_unsupported_ktx2(name, fmt::format("layerCount {} (array textures)", layers));
  if (faces == 6) fail_unsupported_ktx2(name, "faceCount 6 (cube maps)");
  if (faces != 1) fail_damaged_ktx2(name, fmt::format("its faceCount is {}", faces));
  if (header.width > 0 && header.height == 0) fail_unsupported_ktx2(name, "pixelHeight 0 (1D textures)");
  const auto largest = static_cast<uint64_t>(std::max(header.width, header.height));
  if (levels > static_cast<uint64_t>(std::bit_width(largest)))
    fail_damaged_ktx2(name, fmt::format("{}x{} pixels have {} levels", header.width, header.height, levels));
  header.level_count = std::max(levels, 1u);
}

void read_supercompression(Span bytes, Ktx2Header& header, const std::string& name) {
  const uint32_t scheme = word_at(bytes, 44);
  if (scheme == 3) fail_unsupported_ktx2(name, "supercompression 3 (ZLIB)");
  if (scheme > 3) fail_unsupported_ktx2(name, fmt::format("supercompression {}", scheme));
  header.supercompression = static_cast<Ktx2Supercompression>(scheme);
}

/// Required fields of a basic descriptor block.
struct Descriptor {
  uint32_t model = 0;
  uint32_t transfer = 0;
  std::vector<uint32_t> channels;  ///< one per sample
};

Descriptor read_descriptor(Span bytes, const std::string& name) {
  constexpr size_t kTotalSize = 4;
  constexpr size_t kBlockHead = 24;
  constexpr size_t kSample = 16;
  const Span data = part(bytes, word_at(bytes, 48), word_at(bytes, 52), name);
  if (data.size() < kTotalSize + kBlockHead) fail_damaged_ktx2(name, "it has no data format descriptor");
  const Span block = data.subspan(kTotalSize);
  const uint64_t size = number_at(block, 6, 2);
  if (word_at(block, 0) != 0) fail_damaged_ktx2(name, "its first data format descriptor is not a basic one");
  if (size < kBlockHead || size > block.size() || (size - kBlockHead) % kSample != 0)
    fail_damaged_ktx2(name, fmt::format("a data format descriptor has {} bytes", size));
  constexpr uint32_t kPremultiplied = 1;
  if ((number_at(block, 11, 1) & kPremultiplied) != 0) fail_unsupported_ktx2(name, "premultiplied alpha");
  Descriptor descriptor;
  descriptor.model = static_cast<uint32_t>(number_at(block, 8, 1));
  descriptor.transfer = static_cast<uint32_t>(number_at(block, 10, 1));
  for (size_t at = kBlockHead; at < size; at += kSample)
    descriptor.channels.push_back(static_cast<uint32_t>(number_at(block, at + 3, 1) & 15));
  return descriptor;
}

bool is_srgb_transfer(uint32_t transfer, const std::string& name) {
  constexpr uint32_t kUnspecified = 0;
  constexpr uint32_t kLinear = 1;
  constexpr uint32_t kSrgb = 2;
  if (transfer != kUnspecified && transfer != kLinear && transfer != kSrgb)
    fail_unsupported_ktx2(name, fmt::format("transfer function {}", transfer));
  return transfer == kSrgb;
}

/// Vulkan formats with 8 bits per channel, stored without encoding.
struct PlainFormat {
  uint32_t unorm;
  uint32_t srgb;
  size_t channels;
};
constexpr PlainFormat kPlainFormats[] = {{9, 15, 1}, {16, 22, 2}, {23, 29, 3}, {37, 43, 4}};

void read_plain_format(uint32_t format, Ktx2Header& header, const std::string& name) {
  const auto* const plain = std::find_if(std::begin(kPlainFormats), std::end(kPlainFormats),
                                         [&](const PlainFormat& f) { return f.unorm == format || f.srgb == format; });
  if (plain == std::end(kPlainFormats)) fail_unsupported_ktx2(name, fmt::format("VkFormat {}", format));
  if (format == plain->srgb && !header.is_srgb)
    fail_damaged_ktx2(name, fmt::format("VkFormat {} has no sRGB transfer function", format));
  if (header.supercompression == Ktx2Supercompression::basis_lz)
    fail_damaged_ktx2(name, fmt::format("VkFormat {} has BasisLZ supercompression", format));
  header.plain_channels = plain->channels;
  header.has_alpha = plain->channels == 4;
}

void read_uastc_channels(const Descriptor& descriptor, Ktx2Header& header, const std::string& name) {
  enum Channel : uint32_t { kRgb = 0, kRgba = 3, kRrr = 4, kRrrg = 5, kRg = 6 };
  if (header.supercompression == Ktx2Supercompression::basis_lz)
    fail_damaged_ktx2(name, "UASTC has BasisLZ supercompression");
  if (descriptor.channels.size() != 1)
    fail_damaged_ktx2(name, fmt::format("UASTC has {} samples", descriptor.channels.size()));
  switch (descriptor.channels[0]) {
    case kRgb:
    case kRrr: header.channels = "rgb1"; break;
    case kRgba: header.has_alpha = true; break;
    case kRrrg: header.swizzle = kRedAndAlpha; break;
    case kRg: header.channels = "rg01"; break;
    default: fail_damaged_ktx2(name, fmt::format("UASTC has channels {}", descriptor.channels[0]));
  }
}

void read_etc1s_channels(const Descriptor& descriptor, Ktx2Header& header, const std::string& name) {
  enum Channel : uint32_t { kRgb = 0, kRrr = 3, kGgg = 4, kAaa = 15 };
  using Channels = std::vector<uint32_t>;
  if (header.supercompression != Ktx2Supercompression::basis_lz)
    fail_damaged_ktx2(name, "ETC1S has no BasisLZ supercompression");
  const Channels& channels = descriptor.channels;
  header.slices = channels.size();
  if (channels == Channels{kRgb} || channels == Channels{kRrr}) {
    header.channels = "rgb1";
  } else if (channels == Channels{kRgb, kAaa}) {
    header.has_alpha = true;
  } else if (channels == Channels{kRrr, kGgg}) {
    header.swizzle = kRedAndAlpha;
  } else {
    fail_damaged_ktx2(name, fmt::format("ETC1S has an unknown set of {} channels", channels.size()));
  }
}

void read_format(Span bytes, Ktx2Header& header, const std::string& name) {
  constexpr uint32_t kEtc1s = 163;
  constexpr uint32_t kUastc = 166;
  const uint32_t format = word_at(bytes, 12);
  const Descriptor descriptor = read_descriptor(bytes, name);
  header.is_srgb = is_srgb_transfer(descriptor.transfer, name);
  if (format != 0) {
    read_plain_format(format, header, name);
  } else if (descriptor.model == kUastc) {
    header.encoding = Ktx2Encoding::uastc;
    read_uastc_channels(descriptor, header, name);
  } else if (descriptor.model == kEtc1s) {
    header.encoding = Ktx2Encoding::etc1s;
    read_etc1s_channels(descriptor, header, name);
  } else {
    fail_unsupported_ktx2(name, fmt::format("colour model {}", descriptor.model));
  }
}

/// Value of a key without its terminating 0; empty if the key is missing. Entries are a length, the key, a 0 and the
/// value, padded to 4 bytes.
std::string find_value(Span entries, std::string_view key, const std::string& name) {
  uint64_t at = 0;
  while (entries.size() - at >= 4) {
    const uint64_t size = word_at(entries, at);
    const Span entry = part(entries, at + 4, size, name);
    const std::string_view text(reinterpret_cast<const char*>(entry.data()), entry.size());
    if (text.size() > key.size() && text.starts_with(key) && text[key.size()] == '\0') {
      const std::string_view value = text.substr(key.size() + 1);
      return std::string(value.substr(0, value.find('\0')));
    }
    at = std::min<uint64_t>(entries.size(), at + 4 + (size + 3) / 4 * 4);
  }
  return {};
}

void read_swizzle(Span bytes, Ktx2Header& header, const std::string& name) {
  const std::string swizzle = find_value(part(bytes, word_at(bytes, 56), word_at(bytes, 60), name), "KTXswizzle", name);
  if (swizzle.empty()) return;
  if (swizzle.size() != 4 || swizzle.find_first_not_of("rgba01") != std::string::npos)
    fail_damaged_ktx2(name, fmt::format("its KTXswizzle of {} characters must be exactly four of r, g, b, a, 0 and 1",
                                        swizzle.size()));
  header.swizzle = swizzle;
}

}  // namespace

Ktx2Header read_ktx2_header(Span bytes, const std::string& name) {
  if (!is_ktx2(bytes)) fail_damaged_ktx2(name, "it does not have the signature of a KTX2 file");
  if (bytes.size() < kFixedBytes) fail_cut_off_ktx2(name);
  Ktx2Header header;
  read_shape(bytes, header, name);
  read_supercompression(bytes, header, name);
  const Span level = part(bytes, kFixedBytes, header.level_count * kLevelBytes, name).first(kLevelBytes);
  read_format(bytes, header, name);
  read_swizzle(bytes, header, name);
  header.data = part(bytes, number_at(level, 0, 8), number_at(level, 8, 8), name);
  header.uncompressed_bytes = number_at(level, 16, 8);
  if (header.supercompression == Ktx2Supercompression::basis_lz)
    header.global_data = part(bytes, number_at(bytes, 64, 8), number_at(bytes, 72, 8), name);
  return header;
}

}  // namespace relume::detail
