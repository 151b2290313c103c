// Maps scene radiance to display values: exposure, then a tone curve.
#pragma once

#include <array>
#include <string_view>

#include "relume/export.h"
#include "relume/image.h"

namespace relume {

/// Tone curves from linear Rec. 709 in [0, ∞) to display-linear Rec. 709 in [0, 1]. The display's transfer function is
/// applied afterwards.
enum class ToneMap : int {
  none,      ///< clamp
  reinhard,  ///< [Reinhard02 eq. 3]: L/(1+L) on the luminance
  aces,      ///< [Hill15]: fit of the ACES reference rendering transform and the sRGB output transform
  agx,       ///< [Sobotka22], default look, with the polynomial of [Wrensch23]
  neutral,   ///< [Khronos24]: keeps base colours below 0.8, compresses highlights
};

/// Names of the enum's values for settings, in order.
inline constexpr std::array<std::string_view, 5> kToneMapNames{"none", "reinhard", "aces", "agx", "neutral"};

/// Multiplies every pixel by 2^exposure (stops) and applies the curve. write_image() stores the result as PNG, JPEG or
/// TGA.
RELUME_API Image tone_map(const Image& image, ToneMap curve, float exposure);

}  // namespace relume
