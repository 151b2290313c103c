// When an image is done, and the loop that renders frames until then.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <stop_token>

#include "render/settings.h"

namespace relume {

class Session;

/// What the loop needs of a session. Tests provide other functions.
struct FrameSource {
  std::function<bool(std::stop_token)> render_frame;  ///< Session::render_frame
  std::function<uint32_t()> picture_frames;           ///< Session::picture_frames
  std::function<double()> picture_samples;            ///< Session::picture_samples
  std::function<double()> estimated_error;            ///< Session::estimated_error
};

/// Whichever comes first; 0: does not count.
struct StopCriteria {
  uint32_t samples = 0;  ///< a pixel of this image, on average; a loaded checkpoint's included
  double time_s = 0;     ///< of this loop
  double error = 0;
};

/// kDefaultSpp where no criterion is set.
StopCriteria stop_criteria(const StopSettings& settings);

enum class StopReason { samples, time, error, interrupted };
const char* name_of(StopReason reason);

/// Where the loop stands.
struct Accumulation {
  uint32_t frames = 0;
  double samples = 0;  ///< a pixel, on average
  double elapsed_s = 0;
  uint32_t frames_done_here = 0;                           ///< without those of a loaded checkpoint
  double samples_done_here = 0;                            ///< the same, a pixel
  double error = std::numeric_limits<double>::infinity();  ///< as of the last check; infinite before the first
};

/// Share of the work that is done, in [0, 1], by the criterion that is nearest to its end. The error falls with the
/// square root of the number of samples.
double fraction_done(const Accumulation& state, const StopCriteria& criteria);
/// Seconds until the first criterion is met, as far as one can tell; infinite if one cannot.
double remaining_s(const Accumulation& state, const StopCriteria& criteria);

/// Whether the error is looked at after `frames` of a picture: from 16 on (before, the estimated variance is too noisy
/// to stop by), at every frame up to 32, every second up to 64, and so on. It depends on nothing else, so that a
/// resumed render stops where an uninterrupted one does.
bool checks_error_at(uint32_t frames);

/// Calls render_frame until a criterion is met or `stop` requested, and `frame_done` after each complete frame. The
/// first frame is always completed, so that there is a picture. With a time limit no frame begins that would, taking as
/// long as those before it, end beyond it. `now_s` is a clock that only moves forward.
StopReason render_until(const FrameSource& source, const StopCriteria& criteria, const std::function<double()>& now_s,
                        std::stop_token stop, const std::function<void(const Accumulation&)>& frame_done);

/// The same with a session's frames and the real clock. A time limit also ends long preparation early
/// (Session::shorten_preparation_on).
StopReason render_until(Session& session, const StopCriteria& criteria, std::stop_token stop = {},
                        const std::function<void(const Accumulation&)>& frame_done = {});

}  // namespace relume
