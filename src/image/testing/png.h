// PNG files of any bit depth, for tests.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace relume::testing {

/// Colour types.
inline constexpr int kGrey = 0;
inline constexpr int kRgba = 6;

/// An uncompressed PNG (ISO/IEC 15948). `samples` are big-endian rows without filter bytes. Checksums are zero; the
/// decoder ignores them.
inline std::vector<std::byte> make_png(uint32_t width, uint32_t height, int bit_depth, int color_type,
                                       const std::vector<uint8_t>& samples) {
  std::string raw;
  const size_t row = samples.size() / height;
  for (uint32_t y = 0; y < height; ++y) {
    raw.push_back('\0');  // filter: none
    raw.append(samples.begin() + static_cast<std::ptrdiff_t>(y * row),
               samples.begin() + static_cast<std::ptrdiff_t>((y + 1) * row));
  }
  const auto big_endian = [](uint32_t x) {
    return std::string{static_cast<char>(x >> 24), static_cast<char>(x >> 16), static_cast<char>(x >> 8),
                       static_cast<char>(x)};
  };
  const auto chunk = [&](const std::string& type, const std::string& data) {
    return big_endian(static_cast<uint32_t>(data.size())) + type + data + big_endian(0);
  };
  const auto n = static_cast<uint16_t>(raw.size());
  const auto m = static_cast<uint16_t>(~n);
  std::string zlib{0x78, 0x01, 0x01};  // one stored block
  for (const uint16_t x : {n, m}) zlib += {static_cast<char>(x & 255), static_cast<char>(x >> 8)};
  zlib += raw + big_endian(0);
  const std::string header = big_endian(width) + big_endian(height) +
                             std::string{static_cast<char>(bit_depth), static_cast<char>(color_type), 0, 0, 0};
  const std::string file = "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", zlib) + chunk("IEND", "");
  std::vector<std::byte> bytes(file.size());
  std::memcpy(bytes.data(), file.data(), file.size());
  return bytes;
}

}  // namespace relume::testing
