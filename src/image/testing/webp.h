// WebP files for tests, by libwebp's encoder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include <webp/encode.h>

namespace relume::testing {

/// `rgba`: rows from the top, 8 bits a channel. Lossless unless `quality`, up to 100, is at least 0.
inline std::vector<std::byte> make_webp(int width, int height, const std::vector<uint8_t>& rgba, float quality = -1) {
  uint8_t* data = nullptr;
  const size_t size = quality < 0 ? WebPEncodeLosslessRGBA(rgba.data(), width, height, 4 * width, &data)
                                  : WebPEncodeRGBA(rgba.data(), width, height, 4 * width, quality, &data);
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  WebPFree(data);
  return bytes;
}

}  // namespace relume::testing
