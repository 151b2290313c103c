// Keys by their GLFW names, and scripted input. Dear ImGui up to 1.86 numbers keys as GLFW does and exposes its state
// for writing; later versions number keys differently and take events.
#pragma once

#include <algorithm>
#include <vector>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

namespace relume::viewer {

#if IMGUI_VERSION_NUM >= 18700

/// The Dear ImGui key; ImGuiKey_None for keys that the viewer does not use.
inline ImGuiKey imgui_key(int glfw_key) {
  if (glfw_key >= GLFW_KEY_A && glfw_key <= GLFW_KEY_Z)
    return static_cast<ImGuiKey>(ImGuiKey_A + glfw_key - GLFW_KEY_A);
  if (glfw_key >= GLFW_KEY_0 && glfw_key <= GLFW_KEY_9)
    return static_cast<ImGuiKey>(ImGuiKey_0 + glfw_key - GLFW_KEY_0);
  switch (glfw_key) {
    case GLFW_KEY_HOME: return ImGuiKey_Home;
    case GLFW_KEY_F1: return ImGuiKey_F1;
    case GLFW_KEY_F12: return ImGuiKey_F12;
    case GLFW_KEY_TAB: return ImGuiKey_Tab;
    case GLFW_KEY_ENTER: return ImGuiKey_Enter;
    case GLFW_KEY_ESCAPE: return ImGuiKey_Escape;
    case GLFW_KEY_LEFT_BRACKET: return ImGuiKey_LeftBracket;
    case GLFW_KEY_RIGHT_BRACKET: return ImGuiKey_RightBracket;
    case GLFW_KEY_SPACE: return ImGuiKey_Space;
    default: return ImGuiKey_None;
  }
}

#else

inline int imgui_key(int glfw_key) { return glfw_key; }

#endif

inline bool is_down(int glfw_key) { return ImGui::IsKeyDown(imgui_key(glfw_key)); }

/// True in the frame in which the key goes down.
inline bool is_pressed(int glfw_key) { return ImGui::IsKeyPressed(imgui_key(glfw_key), false); }

/// Holds exactly these keys in the next frame.
inline void hold_keys(const std::vector<int>& glfw_keys) {
  ImGuiIO& io = ImGui::GetIO();
  const auto held = [&](int key) { return std::find(glfw_keys.begin(), glfw_keys.end(), key) != glfw_keys.end(); };
#if IMGUI_VERSION_NUM >= 18700
  io.ConfigInputTrickleEventQueue = false;  // otherwise, simultaneous keys arrive one frame after the other
  for (int key = GLFW_KEY_SPACE; key <= GLFW_KEY_LAST; ++key) {
    if (imgui_key(key) != ImGuiKey_None) io.AddKeyEvent(imgui_key(key), held(key));
  }
  io.AddKeyEvent(ImGuiMod_Shift, held(GLFW_KEY_LEFT_SHIFT));
  io.AddKeyEvent(ImGuiMod_Ctrl, held(GLFW_KEY_LEFT_CONTROL));
  io.AddKeyEvent(ImGuiMod_Alt, held(GLFW_KEY_LEFT_ALT));
#else
  for (int key = GLFW_KEY_SPACE; key <= GLFW_KEY_LAST; ++key) io.KeysDown[key] = held(key);
  io.KeyShift = held(GLFW_KEY_LEFT_SHIFT);
  io.KeyCtrl = held(GLFW_KEY_LEFT_CONTROL);
  io.KeyAlt = held(GLFW_KEY_LEFT_ALT);
#endif
}

/// Sets the mouse for the next frame; `wheel` in notches.
inline void hold_mouse(const ImVec2& position, bool left, float wheel) {
  ImGuiIO& io = ImGui::GetIO();
#if IMGUI_VERSION_NUM >= 18700
  io.AddMousePosEvent(position.x, position.y);
  io.AddMouseButtonEvent(ImGuiMouseButton_Left, left);
  if (wheel != 0.0f) io.AddMouseWheelEvent(0.0f, wheel);
#else
  io.MousePos = position;
  io.MouseDown[ImGuiMouseButton_Left] = left;
  io.MouseWheel = wheel;
#endif
}

}  // namespace relume::viewer
