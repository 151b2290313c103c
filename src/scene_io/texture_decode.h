// Decodes image files to textures for scene loaders.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// Decodes PNG, JPEG, TGA, BMP, KTX2, WebP, HDR or EXR, recognised by content. `name` becomes the texture's name and
/// appears in messages. The result's format is `wanted` if the file allows it:
///
///   rgba8_srgb    8 bits as stored; 16-bit PNGs are rounded to 8 (invisible in sRGB-encoded colour)
///   rgba8_linear  8 bits as stored; 16-bit PNGs become rgba32_float in [0, 1], since normals band at 8 bits
///   rgba32_float  linear; RGB of 8- and 16-bit files is decoded from sRGB, except in linear KTX2 files;
///                 alpha is not decoded
///
/// HDR and EXR always become rgba32_float. EXR alpha is channel "A", else 1. Grey is replicated. Throws Error.
Texture decode_texture(std::span<const std::byte> bytes, const std::string& name, PixelFormat wanted);

/// Limits the total decoded texels of a scene's images, so that many small files cannot exhaust memory.
class DecodeBudget {
 public:
  /// Texels allowed at any file size: 2 GiB of 8-bit texels, 32 images of 4096 × 4096.
  static constexpr uint64_t kFreeTexels = uint64_t{1} << 29;
  /// Additional texels per byte of the files. Real textures take more than an eighth of a bit per texel.
  static constexpr uint64_t kTexelsPerByte = 64;

  /// Returns whether an image fits, and counts it if so. Counts its file bytes in any case.
  bool take(uint64_t texels, uint64_t file_bytes);

 private:
  uint64_t texels_ = 0;
  uint64_t file_bytes_ = 0;
};

/// Clamps a float texture to [0, 1] if `wanted` is rgba8_linear (data and normals), else to [0, kMaxRadiance]. NaN
/// becomes 0. Returns a sentence about the repairs, empty if none.
std::string repair_texels(Texture& texture, const std::string& name, PixelFormat wanted);

}  // namespace relume
