// Colours, fonts and sizes of the interface.
#pragma once

#include <imgui/imgui.h>

namespace relume::viewer {

inline constexpr ImU32 kAccent = IM_COL32(242, 166, 90, 255);
inline constexpr ImU32 kTextDim = IM_COL32(150, 155, 165, 255);
inline constexpr ImU32 kProblem = IM_COL32(240, 96, 88, 255);
inline constexpr ImU32 kOverlay = IM_COL32(18, 19, 23, 205);

/// A dark theme with the accent colour. `scale`: of the display's pixels.
void apply_theme(float scale);

/// A monospaced font; the ordinary one if the system has no other.
ImFont* monospace_font();

}  // namespace relume::viewer
