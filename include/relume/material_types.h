// Closed lists of what materials and textures can be.
#pragma once

#include <cstdint>

namespace relume {

/// How a texture stores its texels.
enum class PixelFormat : uint8_t {
  rgba8_srgb,    ///< 4 bytes a texel; RGB carries the sRGB transfer function, alpha is linear
  rgba8_linear,  ///< 4 bytes a texel, data (roughness, normals)
  rgba32_float,  ///< 16 bytes a texel, linear
};
enum class WrapMode : uint8_t { repeat, clamp, mirror };
enum class FilterMode : uint8_t { nearest, linear };

/// What alpha means (glTF 2.0).
enum class AlphaMode : uint8_t { opaque, mask, blend };

/// Distribution of microfacet normals.
enum class MicrofacetModel : uint8_t { ggx, beckmann };

}  // namespace relume
