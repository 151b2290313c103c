// The settings panel, generated from declarations: the essential settings first, all by search.
#pragma once

#include "viewer/state.h"

namespace relume::viewer {

/// Widgets for the edited side.
void draw_settings_panel(State& state);

/// Reason why a choice is incompatible with the other settings; empty if it is compatible.
std::string refusal(const AllSettings& settings, const std::string& setting, std::string_view choice);

/// The slot's choice that a technique's setting requires to take effect ("history = reproject"), if it is not the
/// present one; empty otherwise. Settings belong to the choice whose name is their prefix.
std::string takes_effect_with(const AllSettings& settings, const std::string& setting);

}  // namespace relume::viewer
