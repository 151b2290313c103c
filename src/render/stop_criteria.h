// When an image is done, and the loop that renders frames until then.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>

#include "relume/render.h"
#include "render/settings.h"

namespace relume {

/// What the loop needs of a session. Tests provide other functions.
struct FrameSource {
  std::function<bool(std::stop_token)> render_frame;  ///< Session::render_frame
  std::function<uint32_t()> image_frames;             ///< Session::image_frames
  std::function<double()> image_samples;              ///< Session::image_samples
  std::function<double()> estimated_error;            ///< Session::estimated_error
};

/// kDefaultSpp where no criterion is set.
RenderLimits stop_criteria(const StopSettings& settings);

/// Whether the error is looked at after `frames` of an image: from 16 on (before, the estimated variance is too noisy
/// to stop by), at every frame up to 32, every second up to 64, and so on. It depends on nothing else, so that a
/// resumed render stops where an uninterrupted one does.
bool checks_error_at(uint32_t frames);

/// Calls render_frame until a criterion is met or `stop` requested, and `frame_done` after each complete frame. The
/// first frame is always completed, so that there is an image. With a time limit no frame begins that would, taking as
/// long as those before it, end beyond it. `now_s` is a clock that only moves forward.
StopReason render_until(const FrameSource& source, const RenderLimits& criteria, const std::function<double()>& now_s,
                        std::stop_token stop, const std::function<void(const RenderProgress&)>& frame_done);

}  // namespace relume
