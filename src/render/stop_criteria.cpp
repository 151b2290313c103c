#include "render/stop_criteria.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/clock.h"
#include "render/session.h"
#include "render/settings.h"
#include "render/timed_stop.h"

namespace relume {

RenderLimits stop_criteria(const StopSettings& settings) {
  RenderLimits criteria{static_cast<uint32_t>(settings.spp), static_cast<double>(settings.time_s),
                        static_cast<double>(settings.error)};
  const bool none = criteria.samples == 0 && criteria.time_s == 0 && criteria.error == 0;
  if (none) criteria.samples = kDefaultSpp;
  return criteria;
}

RenderLimits limits_of(const Settings& settings) { return stop_criteria(all_settings(settings).stop); }

const char* name_of(StopReason reason) {
  switch (reason) {
    case StopReason::samples: return "samples";
    case StopReason::time: return "time";
    case StopReason::error: return "error";
    case StopReason::interrupted: return "interrupted";
  }
  return "";
}

double fraction_done(const RenderProgress& state, const RenderLimits& criteria) {
  double fraction = 0;
  if (criteria.samples > 0) fraction = state.samples / criteria.samples;
  if (criteria.time_s > 0) fraction = std::max(fraction, state.elapsed_s / criteria.time_s);
  if (criteria.error > 0) {
    const double ratio = criteria.error / std::max(state.error, criteria.error);
    fraction = std::max(fraction, ratio * ratio);
  }
  return std::min(fraction, 1.0);
}

double remaining_s(const RenderProgress& state, const RenderLimits& criteria) {
  double remaining = std::numeric_limits<double>::infinity();
  if (criteria.time_s > 0) remaining = criteria.time_s - state.elapsed_s;
  if (state.samples_done_here > 0) {
    const double sample_s = state.elapsed_s / state.samples_done_here;
    if (criteria.samples > 0) remaining = std::min(remaining, sample_s * (criteria.samples - state.samples));
    const double ratio = criteria.error > 0 ? state.error / criteria.error : 0;
    if (criteria.error > 0) remaining = std::min(remaining, sample_s * state.samples * (ratio * ratio - 1));
  }
  return std::max(remaining, 0.0);
}

bool checks_error_at(uint32_t frames) {
  constexpr uint32_t kFirst = 16;
  return frames >= kFirst && frames % (std::bit_floor(frames) / kFirst) == 0;
}

StopReason render_until(const FrameSource& source, const RenderLimits& criteria, const std::function<double()>& now_s,
                        std::stop_token stop, const std::function<void(const RenderProgress&)>& frame_done) {
  const double start_s = now_s();
  RenderProgress state{.frames = source.image_frames(), .samples = source.image_samples()};
  const double loaded = state.samples;
  const bool errors_count = criteria.error > 0;
  while (true) {
    if (errors_count && checks_error_at(state.frames)) {
      state.error = source.estimated_error();
      if (state.error <= criteria.error) return StopReason::error;
    }
    if (criteria.samples > 0 && state.samples >= criteria.samples) return StopReason::samples;
    if (state.frames > 0) {
      if (stop.stop_requested()) return StopReason::interrupted;
      const double frame_s = state.frames_done_here > 0 ? state.elapsed_s / state.frames_done_here : 0;
      if (criteria.time_s > 0 && state.elapsed_s + frame_s > criteria.time_s) return StopReason::time;
    }
    const bool may_stop = state.frames > 0 || !criteria.completes_first_frame;
    if (!source.render_frame(may_stop ? stop : std::stop_token{})) return StopReason::interrupted;
    state.frames = source.image_frames();
    state.samples = source.image_samples();
    ++state.frames_done_here;
    state.samples_done_here = state.samples - loaded;
    state.elapsed_s = now_s() - start_s;
    if (frame_done) frame_done(state);
  }
}

StopReason render_until(Session& session, const RenderLimits& criteria, std::stop_token stop,
                        const std::function<void(const RenderProgress&)>& frame_done) {
  const FrameSource source{
      .render_frame = [&session](std::stop_token token) { return session.render_frame(std::move(token)); },
      .image_frames = [&session] { return session.image_frames(); },
      .image_samples = [&session] { return session.image_samples(); },
      .estimated_error = [&session] { return session.estimated_error(); },
  };
  const TimedStop timer(stop, criteria.time_s);
  session.shorten_preparation_on(timer.token());
  return render_until(source, criteria, now_s, stop, frame_done);
}

}  // namespace relume
