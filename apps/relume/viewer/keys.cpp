#include "viewer/actions.h"
#include "viewer/imgui_input.h"
#include "viewer/viewport.h"

namespace relume::viewer {
namespace {

float axis(int positive, int negative) {
  return static_cast<float>(is_down(positive)) - static_cast<float>(is_down(negative));
}

void fly(State& state, float seconds, float image_height_px) {
  const ImGuiIO& io = ImGui::GetIO();
  FlyInput input;
  if (!io.WantTextInput && !io.KeyCtrl)
    input.move = {axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q), axis(GLFW_KEY_S, GLFW_KEY_W)};
  input.fast = io.KeyShift;
  input.turn_px = state.look_px;
  state.look_px = Vec2(0);
  if (input.idle() || !state.knows_camera()) return;
  CameraPose placed = current_camera(state);
  if (!state.flying) state.fly.place(placed.to_world);
  if (!state.fly.update(input, seconds, placed.camera.fov_y_rad, image_height_px)) return;
  state.flying = true;
  state.path.playing = false;
  placed.to_world = state.fly.to_world();
  state.document->set_camera(placed);
  state.touch();
}

void expose(State& state, float stops) {
  for (size_t side = 0; side < state.settings.size(); ++side) {
    std::optional<float>& exposure = state.settings[side].output.exposure;
    exposure = clamp(exposure.value_or(state.automatic_exposure[side]) + stops, -64, 64);
  }
}

void handle_control_keys(State& state) {
  if (is_pressed(GLFW_KEY_S)) save_numbered_view_file(state);
  for (int digit = 0; digit < 9; ++digit) {
    if (is_pressed(GLFW_KEY_1 + digit)) store_bookmark(state, static_cast<size_t>(digit));
  }
}

void handle_plain_keys(State& state) {
  if (is_pressed(GLFW_KEY_HOME)) release_camera(state);
  if (is_pressed(GLFW_KEY_F1)) state.show_help = !state.show_help;
  if (is_pressed(GLFW_KEY_TAB)) state.show_panels = !state.show_panels;
  if (is_pressed(GLFW_KEY_L)) state.inspector.loupe = !state.inspector.loupe;
  if (is_pressed(GLFW_KEY_R)) toggle_recording(state);
  if (is_pressed(GLFW_KEY_K)) add_path_key(state);
  if (is_pressed(GLFW_KEY_P)) state.animating = !state.animating;
  if (is_pressed(GLFW_KEY_ESCAPE)) state.selection = {};
  if (is_pressed(GLFW_KEY_LEFT_BRACKET)) expose(state, -0.5f);
  if (is_pressed(GLFW_KEY_RIGHT_BRACKET)) expose(state, 0.5f);
  if (is_pressed(GLFW_KEY_F12)) save_numbered_image(state, ImGui::GetIO().KeyShift ? ".exr" : ".png");
  if (is_pressed(GLFW_KEY_SPACE)) {
    state.paused = !state.paused;
    state.request_changed = true;
  }
  if (is_pressed(GLFW_KEY_B)) set_split(state, !state.split);
  for (int digit = 0; digit < 9; ++digit) {
    if (is_pressed(GLFW_KEY_1 + digit)) go_to_bookmark(state, static_cast<size_t>(digit));
  }
}

}  // namespace

void handle_keys(State& state, float seconds, float image_height_px) {
  fly(state, seconds, image_height_px);
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput || !state.document) return;
  if (io.KeyCtrl) {
    handle_control_keys(state);
  } else {
    handle_plain_keys(state);
  }
}

}  // namespace relume::viewer
