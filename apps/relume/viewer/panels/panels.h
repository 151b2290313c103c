// Panels beside and below the image, except the settings.
#pragma once

#include "viewer/model/state.h"

namespace relume::viewer {

/// Scenes to open, time, environment, and the selected light, object or material.
void draw_scene_panel(State& state);

/// Position, lens, bookmarks, paths, saving the view.
void draw_camera_panel(State& state);

/// Choice and display of the inspected buffer.
void draw_buffers_panel(State& state);

/// Frame times of a side, stacked by pass, with numbers.
void draw_timing_panel(State& state, int side);

/// The environment section of the scene panel.
void draw_environment(State& state);

/// Widgets of the selection.
void draw_selection(State& state);

}  // namespace relume::viewer
