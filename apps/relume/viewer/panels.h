// The panels beside and below the image, except the settings.
#pragma once

#include "viewer/state.h"

namespace relume::viewer {

/// Scenes to open, time, environment, and whatever is selected: lights, objects, materials.
void draw_scene_panel(State& state);

/// Position, lens, bookmarks, paths, saving the view.
void draw_camera_panel(State& state);

/// Which buffer is shown, and how.
void draw_buffers_panel(State& state);

/// Frame times stacked by pass, with numbers. `side`: whose.
void draw_timing_panel(State& state, int side);

/// The environment's part of the scene panel.
void draw_environment(State& state);

/// Widgets of what is selected.
void draw_selection(State& state);

/// Selects, and has the scene compiled so that the thing can move.
void select(State& state, const Selection& selection);

}  // namespace relume::viewer
