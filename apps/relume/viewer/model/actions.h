// Actions shared by keys, buttons and scripts.
#pragma once

#include <filesystem>
#include <string>

#include "viewer/model/state.h"

namespace relume::viewer {

/// Stores the view as a new bookmark, or in `slot`.
void add_bookmark(State& state);
void store_bookmark(State& state, size_t slot);
void go_to_bookmark(State& state, size_t slot);

void toggle_recording(State& state);
void toggle_path(State& state);
void add_path_key(State& state);
/// Advances recording or playback of the path.
void update_path(State& state);

/// Advances the animation by `seconds`, in a loop.
void update_animation(State& state, double seconds);

/// Throws Error if the scene, the one that is loading or an environment of the settings is read from `file`.
void check_not_read(const State& state, const std::filesystem::path& file);

/// Queues writing the image of side A between two frames; a message reports the result. Throws Error if the scene is
/// read from `file`.
void save_image(State& state, const std::filesystem::path& file);
/// The same, with an unused name in the working folder: "relume-cornell-0001.png".
void save_numbered_image(State& state, const std::string& extension);

/// Writes camera, path, changes and settings of side A as relume JSON.
void save_view_file(State& state, const std::filesystem::path& file);
void save_numbered_view_file(State& state);
/// Throws Error.
void write_view_file(State& state, const std::filesystem::path& file);

/// Sets the sun of `sky` to its position at the state's hour, day and latitude.
void move_sun(const State& state, SunSky& sky);

/// Requests the object at a point of the image, to select it or to focus on it.
void pick_at(State& state, const Vec2& point, bool focus);
/// Handles the result of pick_at().
void finish_pick(State& state);

/// Selects an item, and makes its node movable, which recompiles the scene.
void select(State& state, const Selection& selection);
/// The node that moves the selection (Document::mover() for a skinned mesh); kNone if it has no position or cannot
/// move.
Index selected_node(const State& state);

/// Shows the buffer "directions" for a point of the image. If no technique fills it, a message names one that would.
void show_directions_at(State& state, const Vec2& point);

/// Moves the selection parallel to the image by `delta`, in heights of the image.
void drag_selection(State& state, const Vec2& delta);

}  // namespace relume::viewer
