// WebP files for tests, by libwebp's encoder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include <webp/encode.h>

namespace relume::testing {

/// `rgba`: rows from the top, 8 bits per channel. Lossless unless `quality`, up to 100, is at least 0.
inline std::vector<std::byte> make_webp(int width, int height, const std::vector<uint8_t>& rgba, float quality = -1) {
  uint8_t* data = nullptr;
  const size_t size = quality < 0 ? WebPEncodeLosslessRGBA(rgba.data(), width, height, 4 * width, &data)
                                  : WebPEncodeRGBA(rgba.data(), width, height, 4 * width, quality, &data);
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  WebPFree(data);
  return bytes;
}

/// 30 bytes: the header of a lossless image with invalid data.
inline std::vector<std::byte> webp_header(int width, int height) {
  constexpr std::string_view kChunks("RIFF\x16\0\0\0WEBPVP8L\x0a\0\0\0\x2f", 21);
  std::vector<std::byte> bytes;
  for (const char c : kChunks) bytes.push_back(static_cast<std::byte>(c));
  const uint32_t sizes = static_cast<uint32_t>(width - 1) | static_cast<uint32_t>(height - 1) << 14;
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::byte>(sizes >> (8 * i)));
  bytes.resize(30);
  return bytes;
}

}  // namespace relume::testing
