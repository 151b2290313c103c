#include "experiments/measure/adaptation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/hash.h"

namespace relume {

namespace {

constexpr uint32_t kBootstrapSeed = 0x3c6ef372u;
constexpr uint32_t kResamples = 400;

struct FrameMean {
  double mse = 0;
  double standard_error = 0;
};

/// By frame, over the runs with these numbers.
std::vector<FrameMean> frame_means(const std::vector<std::vector<double>>& runs, const std::vector<size_t>& chosen) {
  std::vector<FrameMean> means;
  for (size_t frame = 0; frame < runs.front().size(); ++frame) {
    std::vector<double> values;
    for (const size_t run : chosen) values.push_back(runs[run][frame]);
    means.push_back({mean(values), standard_deviation(values) / std::sqrt(static_cast<double>(values.size()))});
  }
  return means;
}

std::vector<size_t> all_of(const std::vector<std::vector<double>>& runs) {
  std::vector<size_t> numbers(runs.size());
  std::iota(numbers.begin(), numbers.end(), size_t{0});
  return numbers;
}

size_t adapted_after(const std::vector<FrameMean>& frames, double share) {
  const size_t last = std::max<size_t>(frames.size() / 4, 1);
  double plateau = 0;
  for (size_t i = frames.size() - last; i < frames.size(); ++i) plateau += frames[i].mse / static_cast<double>(last);
  const double goal = (1 + share) * plateau;
  size_t after = frames.size();
  for (size_t i = frames.size(); i-- > 0;) {
    if (frames[i].mse - 2 * frames[i].standard_error > goal) break;
    if (frames[i].mse <= goal) after = i;
  }
  return after;
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
    result.push_back(mean({run.end() - static_cast<std::ptrdiff_t>(std::min(frames, run.size())), run.end()}));
  return result;
}

size_t Adaptation::adapted_after(double share) const {
  return relume::adapted_after(frame_means(runs, all_of(runs)), share);
}

Interval Adaptation::adapted_interval(double share) const {
  std::vector<double> values;
  std::vector<size_t> chosen(runs.size());
  for (uint32_t i = 0; i < kResamples; ++i) {
    for (uint32_t k = 0; k < chosen.size(); ++k) chosen[k] = hash(i, k, kBootstrapSeed) % runs.size();
    values.push_back(static_cast<double>(relume::adapted_after(frame_means(runs, chosen), share)));
  }
  std::sort(values.begin(), values.end());
  return {values[kResamples / 40], values[kResamples - 1 - kResamples / 40], 0.95};
}

Adaptation measure_adaptation(const ExperimentContext& context, const std::string& name, Session& session, int runs,
                              int frames, const Reference& reference, const PixelMask& region,
                              const std::function<void(Session&, int)>& before) {
  Adaptation result{name, {}};
  const double noise = reference_noise(reference, region);
  for (int run = 0; run < runs; ++run) {
    session.restart(run + 1);
    result.runs.emplace_back();
    for (int frame = 0; frame < frames; ++frame) {
      context.check_stop();
      if (before) before(session, frame);
      session.render_frame();
      result.runs.back().push_back(frame_mse(session.image(), reference.image, region) - noise);
    }
    context.report(name, (run + 1.0) / runs);
  }
  return result;
}

std::string adapted_text(const Adaptation& adaptation, double share, int first_frame) {
  const Interval interval = adaptation.adapted_interval(share);
  return fmt::format("{} ({:.0f} to {:.0f})", adaptation.adapted_after(share) + static_cast<size_t>(first_frame),
                     interval.low + first_frame, interval.high + first_frame);
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
