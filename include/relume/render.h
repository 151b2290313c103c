// Rendering until a limit of samples, time or error is reached.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <stop_token>

#include "relume/export.h"
#include "relume/session.h"

namespace relume {

/// Limits of a rendering; the first one reached ends it. 0: no limit. All 0: only a stop request ends it.
struct RenderLimits {
  uint32_t samples = 0;  ///< samples per pixel of this image, on average, including those of a loaded checkpoint
  double time_s = 0;     ///< seconds in this loop
  double error = 0;      ///< relative error of the image, Session::estimated_error()
  bool completes_first_frame = true;  ///< whether a stop request waits for the first frame, so that an image exists
};

/// Limits that the settings spp, time and error set; without any, 64 samples per pixel.
RELUME_API RenderLimits limits_of(const Settings& settings);

/// The reason why a rendering ended: a limit, or a stop request (interrupted).
enum class StopReason { samples, time, error, interrupted };
/// The enumerator's name, such as "samples".
RELUME_API const char* name_of(StopReason reason);

/// Progress of a rendering.
struct RenderProgress {
  uint32_t frames = 0;                                     ///< frames of this image
  double samples = 0;                                      ///< samples per pixel of this image, on average
  double elapsed_s = 0;                                    ///< seconds in this loop
  uint32_t frames_done_here = 0;                           ///< `frames` without those of a loaded checkpoint
  double samples_done_here = 0;                            ///< `samples` without those of a loaded checkpoint
  double error = std::numeric_limits<double>::infinity();  ///< as of the last check; infinite before the first
};

/// Fraction of the work done, in [0, 1], by the criterion that is nearest to its end. Assumes that the error falls with
/// the square root of the number of samples.
RELUME_API double fraction_done(const RenderProgress& state, const RenderLimits& criteria);
/// Estimated seconds until the first criterion is met; infinite without an estimate.
RELUME_API double remaining_s(const RenderProgress& state, const RenderLimits& criteria);

/// Renders frames until a limit is reached or `stop` is requested; calls `frame_done` after each complete frame. With a
/// time limit, no frame begins that is expected to end beyond it, judging by the earlier frames. A stop request or the
/// time limit also shortens preparation (Session::shorten_preparation_on()). Frames and samples count from
/// Session::begin_image().
RELUME_API StopReason render_until(Session& session, const RenderLimits& criteria, std::stop_token stop = {},
                                   const std::function<void(const RenderProgress&)>& frame_done = {});

}  // namespace relume
