// What keys, buttons and scripts have in common.
#pragma once

#include <filesystem>
#include <string>

#include "viewer/state.h"

namespace relume::viewer {

/// Remembers the view as the last bookmark, or as the one at `slot`.
void add_bookmark(State& state);
void store_bookmark(State& state, size_t slot);
void go_to_bookmark(State& state, size_t slot);

void toggle_recording(State& state);
void toggle_path(State& state);
void add_path_key(State& state);
/// Records or plays, if one of the two is going on.
void update_path(State& state);

/// Moves the animation on by `seconds`, round and round.
void update_animation(State& state, double seconds);

/// Has the rendering thread write the image of side A between two frames; a message tells how it went.
void save_image(State& state, const std::filesystem::path& file);
/// The same, with a name in the working folder that no file has then: "relume-cornell-0001.png".
void save_numbered_image(State& state, const std::string& extension);

/// Writes camera, path, changes and settings of side A as relume JSON.
void save_view_file(State& state, const std::filesystem::path& file);
void save_numbered_view_file(State& state);
/// Throws Error.
void write_view_file(State& state, const std::filesystem::path& file);

/// Puts the sun of `sky` where it stands at the state's hour, day and latitude.
void move_sun(const State& state, SunSky& sky);

/// Has the rendering thread find out what lies at a point of the image; it is then selected.
void pick_at(State& state, const Vec2& point, bool focus);
/// Takes the answer.
void finish_pick(State& state);

/// The node that places what is selected, which for a skinned mesh is Document::mover(); kNone for what has no place or
/// cannot be moved.
Index selected_node(const State& state);

/// Shows the buffer "directions" for a point of the image, if a technique fills it; else a message says what would.
void show_directions_at(State& state, const Vec2& point);

/// Moves what is selected parallel to the image by `delta`, in heights of the image.
void drag_selection(State& state, const Vec2& delta);

}  // namespace relume::viewer
