// Key queries under GLFW's key names. Dear ImGui numbers keys as GLFW does up to version 1.86, and on its own since.
#pragma once

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

namespace relume::viewer {

#if IMGUI_VERSION_NUM >= 18700

/// ImGuiKey_None for keys that the viewer does not use.
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

}  // namespace relume::viewer
