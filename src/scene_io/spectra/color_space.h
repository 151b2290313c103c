// Colour spaces of scene files.
#pragma once

#include <optional>
#include <string_view>

#include "scene/scene.h"

namespace relume {

enum class ColorSpace : uint8_t { srgb, dci_p3, rec2020, aces2065_1 };

/// Space of pbrt's name: srgb, dci-p3 (with the white D65), rec2020, aces2065-1.
std::optional<ColorSpace> color_space_named(std::string_view name);

/// CIE XYZ of linear RGB; white has Y = 1.
Mat3 xyz_from(ColorSpace space);

/// Linear Rec. 709 of linear RGB, without adaptation of the white. Colours outside the gamut have negative components.
Mat3 rec709_from(ColorSpace space);

}  // namespace relume
