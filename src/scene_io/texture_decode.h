// From the bytes of an image file to a texture, for scene loaders.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// Decodes PNG, JPEG, TGA, BMP, KTX2, WebP, HDR or EXR, recognised by content; `name` becomes the texture's name and is
/// used in messages. The result's format is `wanted` where the file allows it:
///
///   rgba8_srgb    8 bits as stored; 16-bit PNGs are rounded to 8 (invisible in sRGB-encoded colour)
///   rgba8_linear  8 bits as stored; 16-bit PNGs become rgba32_float in [0, 1], since normals band at 8 bits
///   rgba32_float  linear; RGB of 8- and 16-bit files is decoded from sRGB, except of KTX2 files that are linear;
///                 alpha is not
///
/// HDR and EXR always become rgba32_float; EXR alpha is the channel "A", else 1. Grey is replicated. Throws Error.
Texture decode_texture(std::span<const std::byte> bytes, const std::string& name, PixelFormat wanted);

/// Limits what the images of one scene decode to together, so that many small files do not fill the memory.
class DecodeBudget {
 public:
  /// Texels of images that cost almost no bytes: 2 GiB of 8-bit texels, 32 images of 4096 × 4096.
  static constexpr uint64_t kFreeTexels = uint64_t{1} << 29;
  /// Further ones for each byte of the files. Textures that show something take more than an eighth of a bit a texel.
  static constexpr uint64_t kTexelsPerByte = 64;

  /// Whether an image fits, which then counts.
  bool take(uint64_t texels, uint64_t file_bytes);

 private:
  uint64_t texels_ = 0;
  uint64_t file_bytes_ = 0;
};

/// Makes numbers of a float texture what kernels can bear: at least 0 and at most 1 if `wanted` is rgba8_linear, which
/// holds data and normals, else kMaxRadiance; what is not a number becomes 0. Returns a sentence about it, empty if
/// nothing was wrong.
std::string repair_texels(Texture& texture, const std::string& name, PixelFormat wanted);

}  // namespace relume
