// Camera navigation by mouse and keys.
#pragma once

#include "viewer/model/fly_pace.h"
#include "viewer/model/orbit_camera.h"

namespace relume::viewer {

struct State;

enum class CameraMode : int {
  orbit,  ///< a drag orbits the pivot, the wheel changes the distance
  fly     ///< a drag looks around, the wheel changes the speed
};

struct Navigation {
  CameraMode mode = CameraMode::fly;
  bool mode_chosen = false;  ///< by the user; otherwise depends on the scene, when loaded and with its first frame
  const void* decided_by = nullptr;  ///< the scene whose first frame set the mode
  bool has_pivot = false;
  Vec3 pivot{0};
  FlyPace pace;
  // Mouse input since the last update.
  Vec2 turn_px{0};
  Vec2 pan_px{0};
  float notches = 0;
};

/// Chooses the mode for the scene, unless the user has. Orbit is for objects: scenes without camera or light.
void choose_mode(State& state);
void set_mode(State& state, CameraMode mode);

/// Moves the camera by mouse and keys. `move`: as in FlyInput, from held keys.
void navigate(State& state, const Vec3& move, bool fast, float image_height_px);

/// Frames the selection, or the whole scene without one, and makes it the pivot.
void frame_selection(State& state);

}  // namespace relume::viewer
