#include "compare/rounds.h"

#include <algorithm>
#include <cmath>

#include "metrics/statistics.h"
#include "relume/lab/metrics.h"
#include "render/display.h"

namespace relume {
namespace {

constexpr double kTimedShare = 1.35;  // share of the budget that is timed beforehand
constexpr size_t kTimedFrames = 6;    // of an animation
/// Limits frames if adaptive sampling selects hardly any pixels.
constexpr uint32_t kMostFramesPerSample = 64;

ErrorPoint measure(const TimedSession& session, const Image& image, const Image& reference) {
  const Metrics m = compute_metrics(image, reference, {.flip = false});
  return {session.frames(), session.samples_per_pixel(), session.time_s(), m.mse, m.rel_mse, m.mape, m.nonfinite_a};
}

/// Alternates between contenders. Each renders its share of every round, so that all end together.
class Turns {
 public:
  Turns(const Sessions& sessions, const FramePlan& plan) : sessions_(sessions), plan_(plan) {
    for (const auto& session : sessions) first_sample_.push_back(session->samples_per_pixel());
  }

  /// Calls `rendered(contender)` after each frame. Returns false if `stop` was requested.
  bool run(const std::stop_token& stop, const std::function<void(size_t)>& rendered) {
    const uint64_t rounds = plan_.frames.empty()
                                ? kMostFramesPerSample * static_cast<uint64_t>(std::ceil(plan_.samples))
                                : *std::max_element(plan_.frames.begin(), plan_.frames.end());
    for (uint64_t round = 0; round < rounds; ++round) {
      bool any = false;
      for (size_t i = 0; i < sessions_.size(); ++i) {
        if (!is_due(i, round, rounds)) continue;
        if (stop.stop_requested()) return false;
        sessions_[i]->render_frame();
        rendered(i);
        any = true;
      }
      if (!any && plan_.frames.empty()) break;
    }
    return true;
  }

 private:
  bool is_due(size_t i, uint64_t round, uint64_t rounds) const {
    if (plan_.frames.empty()) return sessions_[i]->samples_per_pixel() - first_sample_[i] < plan_.samples - 1e-9;
    const uint64_t wanted = plan_.frames[i];
    return (round + 1) * wanted / rounds > round * wanted / rounds;
  }

  const Sessions& sessions_;
  const FramePlan& plan_;
  std::vector<double> first_sample_;
};

/// Records the measurements of a repetition of an animation or a still scene.
class Recorder {
 public:
  Recorder(const Sessions& sessions, const ComparisonOptions& options, const std::vector<Reference>& references,
           std::vector<Repetition>& results)
      : sessions_(sessions), options_(options), references_(references), results_(results), images_(sessions.size()) {}

  void frame_rendered(size_t i) {
    if (is_animation(options_) || !is_measured(sessions_[i]->frames())) return;
    results_[i].curve.push_back(measure(*sessions_[i], sessions_[i]->session().image(), references_.front().image));
  }

  /// Called after all contenders have rendered frame `frame` of the animation, or the still scene.
  void image_done(size_t frame) {
    const Reference& reference = references_[frame];
    for (size_t i = 0; i < sessions_.size(); ++i) {
      const TimedSession& session = *sessions_[i];
      Repetition& result = results_[i];
      Image image = session.session().image();
      ErrorPoint point = measure(session, image, reference.image);
      if (is_animation(options_)) point.frames = static_cast<uint32_t>(frame + 1);
      if (result.curve.empty() || result.curve.back().frames != point.frames) result.curve.push_back(point);
      result.mse += point.mse;
      result.rel_mse += point.rel_mse;
      result.mape += point.mape;
      result.nonfinite += point.nonfinite;
      if (frame > 0) {
        result.temporal_error += temporal_error(image, reference.image, reference.surface, images_[i],
                                                references_[frame - 1].image, references_[frame - 1].surface)
                                     .rel_mse;
      }
      images_[i] = std::move(image);
    }
  }

  void finish(const Display& display) {
    const double count = static_cast<double>(references_.size());
    for (size_t i = 0; i < sessions_.size(); ++i) {
      const TimedSession& session = *sessions_[i];
      Repetition& result = results_[i];
      result.seed = render_settings(session.session()).seed;
      result.frames = session.frames();
      result.samples = session.samples_per_pixel();
      result.time_s = session.time_s();
      result.rays = session.rays();
      result.passes = session.passes();
      result.mse /= count;
      result.rel_mse /= count;
      result.mape /= count;
      if (count > 1) result.temporal_error /= count - 1;
      result.flip = compute_metrics(images_[i], references_.back().image,
                                    {.tone_map = display.tone_map, .exposure = display.exposure})
                        .flip;
    }
  }

  std::vector<Image> take_images() { return std::move(images_); }

 private:
  const Sessions& sessions_;
  const ComparisonOptions& options_;
  const std::vector<Reference>& references_;
  std::vector<Repetition>& results_;
  std::vector<Image> images_;
};

/// Seconds of frames, by contender and image.
using FrameTimes = std::vector<std::vector<std::vector<double>>>;

/// Whether frames fill `share_s` by cumulative_time(), or are so slow that no more are needed.
bool fill(const std::vector<double>& frame_s, size_t first, double used_s, double share_s) {
  constexpr double kMostTimes = 4;
  if (used_s < share_s) return false;
  if (used_s > kMostTimes * share_s) return true;
  return cumulative_time({frame_s.begin() + static_cast<std::ptrdiff_t>(first), frame_s.end()}).back() >= share_s;
}

/// Alternates between contenders until each has rendered the first images of an animation, or the still scene, for
/// `share_s` each. Returns std::nullopt if `stop` was requested.
std::optional<FrameTimes> time_images(const Sessions& sessions, const std::vector<float>& times_s, double share_s,
                                      const std::stop_token& stop, const std::function<void(double)>& progress) {
  const size_t images = std::clamp(times_s.size(), size_t{1}, kTimedFrames);
  FrameTimes frame_s(sessions.size());
  for (size_t image = 0; image < images; ++image) {
    std::vector<double> used(sessions.size());
    std::vector<size_t> before(sessions.size());
    for (size_t i = 0; i < sessions.size(); ++i) {
      if (image > 0) sessions[i]->session().set_time(times_s[image]);
      before[i] = sessions[i]->frames();
    }
    for (bool any = true; any;) {
      any = false;
      for (size_t i = 0; i < sessions.size(); ++i) {
        if (fill(sessions[i]->frame_s(), before[i], used[i], share_s)) continue;
        if (stop.stop_requested()) return std::nullopt;
        sessions[i]->render_frame();
        used[i] += sessions[i]->frame_s().back();
        any = true;
      }
      const double least = *std::min_element(used.begin(), used.end());
      progress((static_cast<double>(image) + std::min(least / share_s, 1.0)) / double(images));
    }
    for (size_t i = 0; i < sessions.size(); ++i) {
      const auto& all = sessions[i]->frame_s();
      frame_s[i].emplace_back(all.begin() + static_cast<std::ptrdiff_t>(before[i]), all.end());
    }
  }
  return frame_s;
}

/// Medians of the first, second, … frame over the images that have one.
std::vector<double> median_frames(const std::vector<std::vector<double>>& images) {
  std::vector<double> usual;
  for (size_t k = 0;; ++k) {
    std::vector<double> times;
    for (const auto& image : images) {
      if (k < image.size()) times.push_back(image[k]);
    }
    if (times.empty()) return usual;
    usual.push_back(median(std::move(times)));
  }
}

}  // namespace

std::optional<EqualTime> plan_equal_time(const Sessions& sessions, const std::vector<float>& times_s, double budget_s,
                                         const std::stop_token& stop, const std::function<void(double)>& progress) {
  // Warm-up: the first frames of a process include memory allocation.
  for (const auto& session : sessions) {
    if (stop.stop_requested()) return std::nullopt;
    session->render_frame();
  }
  for (const auto& session : sessions) {
    if (!times_s.empty()) session->session().set_time(times_s.front());
    session->restart(render_settings(session->session()).seed);
  }
  const std::optional<FrameTimes> frame_s = time_images(sessions, times_s, kTimedShare * budget_s, stop, progress);
  if (!frame_s) return std::nullopt;
  std::vector<std::vector<double>> cumulative;
  for (const auto& images : *frame_s) cumulative.push_back(cumulative_time(median_frames(images)));
  return equal_time(cumulative, budget_s);
}

bool run_repetition(const Sessions& sessions, const ComparisonOptions& options, const FramePlan& plan,
                    const std::vector<Reference>& references, int repetition, const std::stop_token& stop,
                    std::vector<Repetition>& results, std::vector<Image>& images,
                    const std::function<void(double)>& progress) {
  for (const auto& session : sessions) {
    if (!options.times_s.empty()) session->session().set_time(options.times_s.front());
    session->restart(session->first_seed() + repetition);
  }
  results.assign(sessions.size(), {});
  Recorder recorder(sessions, options, references, results);
  for (size_t image = 0; image < references.size(); ++image) {
    if (image > 0) {
      for (const auto& session : sessions) session->session().set_time(options.times_s[image]);
    }
    Turns turns(sessions, plan);
    if (!turns.run(stop, [&](size_t i) { recorder.frame_rendered(i); })) return false;
    recorder.image_done(image);
    progress(static_cast<double>(image + 1) / static_cast<double>(references.size()));
  }
  recorder.finish(fixed_display(resolve(options.common).output));
  images = recorder.take_images();
  return true;
}

}  // namespace relume
