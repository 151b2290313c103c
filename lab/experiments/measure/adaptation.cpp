#include "experiments/measure/adaptation.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "experiments/shared_parts.h"

namespace relume {
namespace {

/// Mean of up to `count` frames of a run from `begin` on.
double mean_of(const std::vector<double>& run, size_t begin, size_t count) {
  const size_t end = std::min(begin + count, run.size());
  return mean({run.begin() + static_cast<std::ptrdiff_t>(begin), run.begin() + static_cast<std::ptrdiff_t>(end)});
}

}  // namespace

std::vector<double> Adaptation::at(size_t frame) const {
  std::vector<double> result;
  for (const std::vector<double>& run : runs) result.push_back(run[frame]);
  return result;
}

std::vector<double> Adaptation::plateaus(size_t frames) const {
  std::vector<double> result;
  for (const std::vector<double>& run : runs)
    result.push_back(mean_of(run, run.size() - std::min(frames, run.size()), frames));
  return result;
}

Ratio Adaptation::over_plateau(size_t begin, size_t count) const {
  std::vector<double> means;
  for (const std::vector<double>& run : runs) means.push_back(mean_of(run, begin, count));
  return paired_error_ratio(means, plateaus(std::max<size_t>(runs.front().size() / 4, 1)));
}

Adaptation measure_adaptation(const ExperimentContext& context, const std::string& name, Session& session, int runs,
                              int frames, const Reference& reference, const PixelMask& region,
                              const AdaptationSteps& steps) {
  const double noise = reference_noise(reference, region);
  const auto measure = [&](const ExperimentContext& own, int run) {
    if (steps.start) steps.start(session);
    session.restart(run + 1);
    std::vector<double> errors;
    for (int frame = 0; frame < frames; ++frame) {
      own.check_stop();
      if (steps.before) steps.before(own, session, frame);
      session.render_frame();
      errors.push_back(frame_mse(session.image(), reference.image, region) - noise);
    }
    return errors;
  };
  return {name, deal_parts(context, name, runs, measure)};
}

std::string adaptation_text(const Adaptation& adaptation, size_t adapted) {
  return fmt::format("{} in the first frame, {} in frames {} to {}", share_text(adaptation.over_plateau(0, 1)),
                     share_text(adaptation.over_plateau(adapted - 1, kFramesThatTell)), adapted,
                     adapted + kFramesThatTell - 1);
}

Claim judged_adapted(std::string id, std::string paper, std::string claim, const Adaptation& adaptation,
                     size_t adapted) {
  return judged_within(std::move(id), std::move(paper), std::move(claim),
                       fmt::format("{} of the plateau's MSE, which is {:.3g}", adaptation_text(adaptation, adapted),
                                   adaptation.plateau(adaptation.runs.front().size() / 4)),
                       fmt::format("at most 1.1 in the {} frames from there on", kFramesThatTell),
                       {adaptation.over_plateau(adapted - 1, kFramesThatTell)}, 0, 1.1);
}

ChartBlock adaptation_chart(std::string title, std::string text, const std::vector<Adaptation>& list, int first_frame) {
  Chart chart{.label = "MSE", .x_label = "frame", .y_label = "MSE", .log_x = false, .log_y = true, .curves = {}};
  int color = 0;
  for (const Adaptation& a : list) {
    Curve curve{.name = a.name, .color = color++, .dashed = false, .points = {}};
    const size_t frames = a.runs.front().size();
    for (size_t i = 0; i < frames; ++i) {
      const std::vector<double> values = a.at(i);
      const Interval interval = mean_interval(values);
      curve.points.push_back(
          {static_cast<double>(first_frame) + static_cast<double>(i), mean(values), interval.low, interval.high});
    }
    chart.curves.push_back(std::move(curve));
  }
  return {std::move(title), std::move(text), {std::move(chart)}};
}

}  // namespace relume
