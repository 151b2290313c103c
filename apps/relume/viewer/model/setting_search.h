// Settings in the panel: the essential ones and search results.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "settings/setting.h"

namespace relume::viewer {

/// Names of the most common settings, in the panel's order.
inline constexpr std::array<std::string_view, 10> kEssentialSettings = {
    "exposure", "tone-map", "env", "env-rotation", "env-exposure", "camera", "max-bounces", "lights", "denoise", "spp"};

/// Whether every word of the query is part of the setting's name, help or choices, ignoring case. An empty query
/// matches all.
bool matches(const Setting& setting, std::string_view query);

/// Switches a number to automatic, or to the fixed value `present`, the current automatic one. Does nothing if it
/// already has that mode.
void set_automatic(const OptionalNumberRef& number, bool automatic, float present);

}  // namespace relume::viewer
