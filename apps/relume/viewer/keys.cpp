#include <imgui/imgui_internal.h>

#include "viewer/imgui_input.h"
#include "viewer/model/actions.h"
#include "viewer/viewport.h"

namespace relume::viewer {
namespace {

float axis(int positive, int negative) {
  return static_cast<float>(is_down(positive)) - static_cast<float>(is_down(negative));
}

/// Movement by the fly keys; none while a text is edited.
Vec3 held_movement() {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput || io.KeyCtrl) return Vec3(0);
  return {axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q), axis(GLFW_KEY_S, GLFW_KEY_W)};
}

/// Closes the topmost of: open lists, the list of keys, the selection.
void close_topmost(State& state) {
  if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup)) {
    ImGui::ClosePopupToLevel(0, true);
  } else if (state.show_help) {
    state.show_help = false;
  } else {
    state.selection = {};
  }
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
  if (is_pressed(GLFW_KEY_ESCAPE)) close_topmost(state);
  if (is_pressed(GLFW_KEY_F)) frame_selection(state);
  if (is_pressed(GLFW_KEY_O))
    set_mode(state, state.navigation.mode == CameraMode::orbit ? CameraMode::fly : CameraMode::orbit);
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

void handle_keys(State& state, float image_height_px) {
  if (!state.document) return;
  const ImGuiIO& io = ImGui::GetIO();
  navigate(state, held_movement(), io.KeyShift, image_height_px);
  if (io.WantTextInput) return;
  if (io.KeyCtrl) {
    handle_control_keys(state);
  } else {
    handle_plain_keys(state);
  }
}

}  // namespace relume::viewer
