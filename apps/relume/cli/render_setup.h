// Loading and building the scene of `relume render`.
#pragma once

#include <optional>

#include "cli/render_plan.h"
#include "relume/session.h"

namespace relume::cli {

/// A render before its first frame.
struct RenderSetup {
  RenderPlan plan;
  AllSettings settings;
  float scene_time_s = 0;  ///< of frame 0
  double load_s = 0;
  std::optional<Session> session;
};

/// Loads the scene, resolves the settings and builds the session of the first image. `threads`: if no setting chooses
/// their number; 0: all cores. Throws Error.
RenderSetup set_up_render(const RenderOptions& options, const Verbosity& verbosity, RenderPlan plan, int threads = 0);

/// Time of an image of the plan. Throws UsageError beyond the latest animation time.
float time_of_image(const RenderOptions& options, const RenderPlan& plan, float scene_time_s, size_t index);

}  // namespace relume::cli
