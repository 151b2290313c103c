// Rules for settings, independent of drawing.
#pragma once

#include <string>
#include <string_view>

#include "render/settings.h"

namespace relume::viewer {

/// Reason why a choice is incompatible with the other settings; empty if it is compatible.
std::string refusal(const AllSettings& settings, const std::string& setting, std::string_view choice);

/// The slot's choice that a technique's setting requires to take effect ("history = reproject"), if it is not the
/// present one; empty otherwise. Settings belong to the choice whose name is their prefix.
std::string takes_effect_with(const AllSettings& settings, const std::string& setting);

}  // namespace relume::viewer
