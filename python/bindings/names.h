// Names of the enums of relume's interface.
#pragma once

#include <array>
#include <string_view>

#include "relume/scene.h"

namespace relume::python {

inline constexpr std::array<std::string_view, 3> kPixelFormats{"rgba8-srgb", "rgba8-linear", "rgba32-float"};
inline constexpr std::array<std::string_view, 3> kWrapModes{"repeat", "clamp", "mirror"};
inline constexpr std::array<std::string_view, 2> kFilterModes{"nearest", "linear"};
inline constexpr std::array<std::string_view, 3> kAlphaModes{"opaque", "mask", "blend"};
inline constexpr std::array<std::string_view, 2> kMicrofacetModels{"ggx", "beckmann"};
inline constexpr std::array<std::string_view, 3> kLightTypes{"point", "spot", "directional"};
inline constexpr std::array<std::string_view, 6> kEnvironmentKinds{"none",    "constant", "map",
                                                                   "sun-sky", "studio",   "automatic"};
inline constexpr std::array<std::string_view, 3> kProjections{"perspective", "orthographic", "panoramic"};
inline constexpr std::array<std::string_view, 5> kAnimatedProperties{"translation", "rotation", "scale", "morph-weight",
                                                                     "visible"};
inline constexpr std::array<std::string_view, 3> kInterpolations{"step", "linear", "cubic-spline"};
inline constexpr std::array<std::string_view, 3> kAnimatedParts{"material", "light", "camera"};

// The names are in the order of the enums.
static_assert(static_cast<size_t>(PixelFormat::rgba32_float) == kPixelFormats.size() - 1);
static_assert(static_cast<size_t>(WrapMode::mirror) == kWrapModes.size() - 1);
static_assert(static_cast<size_t>(FilterMode::linear) == kFilterModes.size() - 1);
static_assert(static_cast<size_t>(AlphaMode::blend) == kAlphaModes.size() - 1);
static_assert(static_cast<size_t>(MicrofacetModel::beckmann) == kMicrofacetModels.size() - 1);
static_assert(static_cast<size_t>(PunctualType::directional) == kLightTypes.size() - 1);
static_assert(static_cast<size_t>(EnvironmentKind::automatic) == kEnvironmentKinds.size() - 1);
static_assert(static_cast<size_t>(Projection::panoramic) == kProjections.size() - 1);
static_assert(static_cast<size_t>(AnimatedProperty::visible) == kAnimatedProperties.size() - 1);
static_assert(static_cast<size_t>(Interpolation::cubic_spline) == kInterpolations.size() - 1);
static_assert(static_cast<size_t>(AnimatedPart::camera) == kAnimatedParts.size() - 1);

}  // namespace relume::python
