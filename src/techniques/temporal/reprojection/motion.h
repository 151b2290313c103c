// When histories move with surfaces, and the limits of their sample counts.
#pragma once

#include "frame/frame_context.h"
#include "techniques/temporal/reprojection/settings.h"

namespace relume {

/// Changes that end all histories.
inline constexpr Change kEndsHistory = Change::materials | Change::settings;

/// Changes of indirect light. No validation covers it, so it lags in all kept histories.
inline constexpr Change kMovesScene = Change::geometry | Change::lights;

/// Whether this frame's pixels show surfaces with other positions in the previous frame.
inline bool surfaces_move(const FrameContext& frame) {
  return frame.number > 0 && !includes(frame.changes, kEndsHistory) &&
         includes(frame.changes, Change::camera | kMovesScene);
}

/// Maximum sample count of a history after surfaces have moved.
inline uint32_t history_limit(const FrameContext& frame, const ReprojectionSettings& settings) {
  const bool scene_moves = includes(frame.changes, kMovesScene);
  return static_cast<uint32_t>(scene_moves ? settings.max_samples_changed : settings.max_samples);
}

}  // namespace relume
