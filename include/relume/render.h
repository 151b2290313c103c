// Rendering until an image is done: enough samples, enough time, or an error that is small enough.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <stop_token>

#include "relume/export.h"
#include "relume/session.h"

namespace relume {

/// Limits of a rendering. The first one that is reached ends it; 0: none. All 0: it ends when a stop is requested.
struct RenderLimits {
  uint32_t samples = 0;  ///< a pixel of this image, on average; a loaded checkpoint's included
  double time_s = 0;     ///< of this loop
  double error = 0;
};

/// Which limit ended a rendering.
enum class StopReason { samples, time, error, interrupted };
RELUME_API const char* name_of(StopReason reason);

/// How far a rendering is.
struct RenderProgress {
  uint32_t frames = 0;
  double samples = 0;  ///< a pixel, on average
  double elapsed_s = 0;
  uint32_t frames_done_here = 0;                           ///< without those of a loaded checkpoint
  double samples_done_here = 0;                            ///< the same, a pixel
  double error = std::numeric_limits<double>::infinity();  ///< as of the last check; infinite before the first
};

/// Share of the work that is done, in [0, 1], by the criterion that is nearest to its end. The error falls with the
/// square root of the number of samples.
RELUME_API double fraction_done(const RenderProgress& state, const RenderLimits& criteria);
/// Seconds until the first criterion is met, as far as one can tell; infinite if one cannot.
RELUME_API double remaining_s(const RenderProgress& state, const RenderLimits& criteria);

/// Renders frames until a limit is reached or `stop` requested, and calls `frame_done` after each complete frame. The
/// first frame is always completed, so that there is an image. With a time limit no frame begins that would, taking as
/// long as those before it, end beyond it; long preparation ends early (Session::shorten_preparation_on). Frames and
/// samples count from Session::begin_image().
RELUME_API StopReason render_until(Session& session, const RenderLimits& criteria, std::stop_token stop = {},
                                   const std::function<void(const RenderProgress&)>& frame_done = {});

}  // namespace relume
