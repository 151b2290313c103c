// Closed lists of material and texture properties.
#pragma once

#include <cstdint>

namespace relume {

/// Storage format of texels.
enum class PixelFormat : uint8_t {
  rgba8_srgb,    ///< 4 bytes per texel; RGB carries the sRGB transfer function, alpha is linear
  rgba8_linear,  ///< 4 bytes per texel, data (roughness, normals)
  rgba32_float,  ///< 16 bytes per texel, linear
};
enum class WrapMode : uint8_t { repeat, clamp, mirror };
enum class FilterMode : uint8_t { nearest, linear };

/// Interpretation of alpha (glTF 2.0).
enum class AlphaMode : uint8_t { opaque, mask, blend };

/// Distribution of microfacet normals.
enum class MicrofacetModel : uint8_t { ggx, beckmann };

}  // namespace relume
