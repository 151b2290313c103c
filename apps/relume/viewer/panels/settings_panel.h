// The settings panel, generated from declarations: the essential settings first, all by search.
#pragma once

#include "viewer/model/state.h"

namespace relume::viewer {

/// Widgets for the edited side.
void draw_settings_panel(State& state);

}  // namespace relume::viewer
