#include "viewer/model/navigation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "viewer/model/actions.h"
#include "viewer/model/state.h"

namespace relume::viewer {
namespace {

// Distances between camera and pivot, as fractions of the scene's diagonal.
constexpr float kNearest = 1e-3f;
constexpr float kFarthest = 100;
constexpr float kLeastDistance = 0.05f;  // minimum, of a pivot chosen straight ahead

/// Bounds of the selection; of the whole scene if the selection has no position.
Box selected_box(const State& state) {
  const Document& document = *state.document;
  const Index node = state.selection.kind == Selected::node ? state.selection.index : selected_node(state);
  if (node == kNone) return document.bounds();
  Box box = document.bounds(node);
  if (!box.empty()) return box;
  const Vec3 place(document.world()[static_cast<size_t>(node)][3]);
  const float reach = 0.05f * document.bounds().diagonal();
  box.add(place - reach);
  box.add(place + reach);
  return box;
}

/// Scenes of a single point get a non-zero size, so that the wheel works.
float size_of(const Box& scene) { return scene.diagonal() > 0 ? scene.diagonal() : 1.0f; }

/// The present pivot if it is visible, since bookmarks and paths only move the camera. Otherwise the scene's centre if
/// the scene's own camera shows it, else a point straight ahead.
Vec3 pivot_of(State& state, const CameraPose& camera) {
  Navigation& n = state.navigation;
  const RenderSettings& render = state.settings[0].render;
  const float aspect = static_cast<float>(render.width) / static_cast<float>(render.height);
  if (std::exchange(n.has_pivot, true) && is_on_screen(camera, n.pivot, aspect)) return n.pivot;
  const Box box = state.document->bounds();
  n.pivot = box.empty() ? Vec3(0) : box.center();
  if (state.flying || !is_on_screen(camera, n.pivot, aspect))
    n.pivot = pivot_ahead(camera, n.pivot, kLeastDistance * size_of(box));
  return n.pivot;
}

void move_about_pivot(State& state, CameraPose& camera, float image_height_px) {
  Navigation& n = state.navigation;
  Vec3 pivot = pivot_of(state, camera);
  if (n.turn_px != Vec2(0)) orbit(camera, pivot, n.turn_px / image_height_px);
  if (n.notches == 0) return;
  const float size = size_of(state.document->bounds());
  dolly(camera, pivot, n.notches, {kNearest * size, kFarthest * size});
}

/// Returns whether the camera moved.
bool fly(State& state, CameraPose& camera, FlyInput input, float image_height_px) {
  const uint64_t shown =
      state.frame() && state.frame()->scene == state.document->loaded() ? state.frame()->request_version : 0;
  const float seconds = state.navigation.pace.step(input.move != Vec3(0), shown, state.now_s);
  if (seconds == 0) input.move = Vec3(0);
  if (!state.flying) state.fly.place(camera.to_world);
  const Vec3 before = Vec3(camera.to_world[3]);
  if (!state.fly.update(input, seconds, camera.camera.fov_y_rad, image_height_px)) return false;
  camera.to_world = state.fly.to_world();
  state.navigation.pivot += state.fly.eye() - before;
  return true;
}

void take_camera(State& state, const CameraPose& camera) {
  state.fly.place(camera.to_world);
  state.flying = true;
  state.path.playing = false;
  state.document->set_camera(camera);
  state.touch();
}

}  // namespace

void choose_mode(State& state) {
  Navigation& n = state.navigation;
  const Document& document = *state.document;
  const bool shown = state.frame() && state.frame()->scene == document.loaded();
  if (n.mode_chosen || n.decided_by == document.loaded().get()) return;
  if (shown) n.decided_by = document.loaded().get();
  const bool is_object = document.outline().cameras.empty() || (shown && state.frame()->in_studio);
  n.mode = is_object ? CameraMode::orbit : CameraMode::fly;
}

void set_mode(State& state, CameraMode mode) {
  Navigation& n = state.navigation;
  n.mode_chosen = true;
  n.mode = mode;
  state.notify(mode == CameraMode::orbit ? "orbit: drag rotates, the wheel changes the distance"
                                         : "fly: drag looks around, the wheel changes the speed");
}

void navigate(State& state, const Vec3& move, bool fast, float image_height_px) {
  Navigation& n = state.navigation;
  const bool orbits = n.mode == CameraMode::orbit;
  if (!orbits && n.notches != 0) state.fly.speed = clamp(state.fly.speed * std::exp2(0.25f * n.notches), 0.001f, 1e4f);
  if (state.has_camera()) {
    const float height_px = std::max(image_height_px, 1.0f);
    CameraPose camera = current_camera(state);
    bool moved = fly(state, camera, {move, orbits ? Vec2(0) : n.turn_px, fast}, height_px);
    if (orbits && (n.turn_px != Vec2(0) || n.notches != 0)) {
      move_about_pivot(state, camera, height_px);
      moved = true;
    }
    if (!orbits && n.turn_px != Vec2(0)) n.has_pivot = false;  // the camera faces another direction
    if (n.pan_px != Vec2(0)) {
      pivot_of(state, camera);
      pan(camera, n.pivot, n.pan_px / height_px);
      moved = true;
    }
    if (moved) take_camera(state, camera);
  }
  n.turn_px = n.pan_px = Vec2(0);
  n.notches = 0;
}

void frame_selection(State& state) {
  const Box box = selected_box(state);
  if (box.empty() || !state.has_camera()) return;
  CameraPose camera = current_camera(state);
  const RenderSettings& render = state.settings[0].render;
  frame_box(camera, box, static_cast<float>(render.width) / static_cast<float>(render.height));
  take_camera(state, camera);
  state.navigation.pivot = box.center();
  state.navigation.has_pivot = true;
}

}  // namespace relume::viewer
