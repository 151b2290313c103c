// Settings, generated from their declarations: the essential ones first, all of them by search.
#pragma once

#include "viewer/state.h"

namespace relume::viewer {

/// Widgets for the edited side.
void draw_settings_panel(State& state);

/// Why a choice cannot be taken with the other settings as they are; empty if it can.
std::string refusal(const AllSettings& settings, const std::string& setting, std::string_view choice);

/// Which choice of which slot a technique's setting takes effect with ("history = reproject") if that is not the
/// present one; empty otherwise. Settings belong to the choice whose name is their prefix.
std::string takes_effect_with(const AllSettings& settings, const std::string& setting);

}  // namespace relume::viewer
