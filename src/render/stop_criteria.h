// Stopping criteria, and the loop that renders frames until one is met.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>

#include "relume/render.h"
#include "render/settings.h"

namespace relume {

/// The loop's interface to a session. Tests provide other functions.
struct FrameSource {
  std::function<bool(std::stop_token)> render_frame;  ///< Session::render_frame
  std::function<uint32_t()> image_frames;             ///< Session::image_frames
  std::function<double()> image_samples;              ///< Session::image_samples
  std::function<double()> estimated_error;            ///< Session::estimated_error
};

/// Limits of a render; kDefaultSpp if no criterion is set.
RenderLimits stop_criteria(const StopSettings& settings);

/// Whether the error is checked after `frames` of an image. Checks start at 16, because the variance estimate is too
/// noisy before: every frame up to 32, every second one up to 64, and so on. Depends only on `frames`, so a resumed
/// render stops at the same frame as an uninterrupted one.
bool checks_error_at(uint32_t frames);

/// Calls render_frame until a criterion is met or `stop` is requested, and `frame_done` after each complete frame. The
/// first frame is always completed, so an image always exists. With a time limit, no frame begins that would exceed it
/// at the mean duration of the frames so far. `now_s` is a monotonic clock.
StopReason render_until(const FrameSource& source, const RenderLimits& criteria, const std::function<double()>& now_s,
                        std::stop_token stop, const std::function<void(const RenderProgress&)>& frame_done);

}  // namespace relume
