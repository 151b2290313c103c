// Which settings the panel shows: the essential ones, and those that a search finds.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "settings/setting.h"

namespace relume::viewer {

/// Names of the settings that most people need, in the order in which the panel shows them.
inline constexpr std::array<std::string_view, 10> kEssentialSettings = {
    "exposure", "tone-map", "env", "env-rotation", "env-exposure", "camera", "max-bounces", "lights", "denoise", "spp"};

/// Whether every word of the query is part of the setting's name, help or choices, whatever the case. An empty query
/// finds all.
bool matches(const Setting& setting, std::string_view query);

/// Switches a number to automatic, or to the fixed value `present`, the current automatic one. Does nothing if it is in
/// that mode already.
void set_automatic(const OptionalNumberRef& number, bool automatic, float present);

}  // namespace relume::viewer
