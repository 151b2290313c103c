#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <imgui/imgui.h>
#include <glm/trigonometric.hpp>

#include "relume/error.h"
#include "viewer/model/actions.h"
#include "viewer/panels/panels.h"
#include "viewer/panels/theme.h"
#include "viewer/panels/widgets.h"

namespace relume::viewer {
namespace {

void draw_lens(State& state) {
  CameraPose placed = current_camera(state);
  Vec3 eye(placed.to_world[3]);
  bool changed = false;
  if (ImGui::DragFloat3("eye", &eye.x, 0.01f, 0, 0, "%.3f")) {
    placed.to_world[3] = Vec4(eye, 1);
    changed = true;
  }
  if (placed.camera.projection == Projection::perspective) {
    changed |= angle_widget("field of view", placed.camera.fov_y_rad, 5, 150);
    changed |= ImGui::DragFloat("lens radius", &placed.camera.lens_radius, 0.001f, 0, 10, "%.4f m",
                                ImGuiSliderFlags_AlwaysClamp);
    tooltip("0: pinhole camera, without depth of field");
    changed |= ImGui::DragFloat("focus", &placed.camera.focus_distance, 0.02f, 0.001f, 1e6f, "%.3f m",
                                ImGuiSliderFlags_AlwaysClamp);
    tooltip("Ctrl+Shift+click in the image focuses on a point");
  }
  ImGui::SliderFloat("speed", &state.fly.speed, 0.01f, 100, "%.2f m/s",
                     ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
  tooltip("Fly speed; the mouse wheel changes it, Shift multiplies it by five");
  if (changed) {
    state.fly.place(placed.to_world);
    state.flying = true;
    state.document->set_camera(placed);
    state.touch();
  }
  ImGui::BeginDisabled(!state.flying);
  if (ImGui::Button("Scene's camera")) release_camera(state);
  ImGui::EndDisabled();
  tooltip("Returns to the scene's camera [Home]");
}

void draw_mode(State& state) {
  int mode = static_cast<int>(state.navigation.mode);
  ImGui::RadioButton("orbit", &mode, static_cast<int>(CameraMode::orbit));
  tooltip("Drag orbits the object, the wheel changes the distance [O]");
  ImGui::SameLine();
  ImGui::RadioButton("fly", &mode, static_cast<int>(CameraMode::fly));
  tooltip("Drag looks around, the wheel changes the speed [O]");
  if (mode != static_cast<int>(state.navigation.mode)) set_mode(state, static_cast<CameraMode>(mode));
  ImGui::SameLine();
  if (ImGui::Button("Frame")) frame_selection(state);
  tooltip("Frames the selection, or the whole scene if nothing is selected [F]");
}

void draw_bookmarks(State& state) {
  heading("Bookmarks");
  for (size_t i = 0; i < state.bookmarks.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Button(state.bookmarks[i].name.c_str())) go_to_bookmark(state, i);
    if (i < 9) tooltip(fmt::format("Key {}", i + 1));
    ImGui::SameLine(ImGui::GetContentRegionMax().x - 2 * ImGui::GetFontSize());
    if (ImGui::SmallButton("x")) {
      state.bookmarks.erase(state.bookmarks.begin() + static_cast<std::ptrdiff_t>(i));
      save_bookmarks(state);
    }
    tooltip("Deletes this bookmark");
    ImGui::PopID();
  }
  if (ImGui::Button("Store this view")) add_bookmark(state);
  tooltip("Ctrl and a digit store a view; the digit alone returns to it");
}

void draw_path(State& state) {
  heading("Camera path");
  PathTools& tools = state.path;
  ImGui::Text("%zu key frames, %.1f s", tools.path.keys().size(), static_cast<double>(tools.path.duration_s()));
  if (ImGui::Button(tools.recording ? "Stop recording" : "Record")) toggle_recording(state);
  tooltip("Records ten key frames per second while you fly [R]");
  ImGui::SameLine();
  if (ImGui::Button("Add key")) add_path_key(state);
  tooltip("Adds this view at a fixed interval after the last key [K]");
  ImGui::SameLine();
  ImGui::BeginDisabled(tools.path.keys().size() < 2);
  if (ImGui::Button(tools.playing ? "Stop" : "Play")) toggle_path(state);
  ImGui::EndDisabled();
  ImGui::SameLine();
  if (ImGui::Button("Clear")) tools = {};
  ImGui::SliderFloat("between keys", &tools.spacing_s, 0.1f, 10, "%.1f s", ImGuiSliderFlags_AlwaysClamp);
}

void draw_files(State& state) {
  heading("Files");
  if (ImGui::Button("Image as PNG")) save_numbered_image(state, ".png");
  tooltip("The displayed image [F12]");
  ImGui::SameLine();
  if (ImGui::Button("as EXR")) save_numbered_image(state, ".exr");
  tooltip("Linear radiance, with every recorded buffer as a layer [Shift+F12]");
  if (ImGui::Button("View as relume JSON")) save_numbered_view_file(state);
  tooltip("Camera or path, edits of the scene, and settings; `relume render` reads it like any scene [Ctrl+S]");
}

}  // namespace

void draw_camera_panel(State& state) {
  if (!state.document) return;
  ImGui::BeginChild("camera");
  ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.62f);
  draw_mode(state);
  draw_lens(state);
  draw_bookmarks(state);
  draw_path(state);
  draw_files(state);
  ImGui::PopItemWidth();
  ImGui::EndChild();
}

}  // namespace relume::viewer
