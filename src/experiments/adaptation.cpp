#include "experiments/adaptation.h"

#include <algorithm>
#include <cmath>

namespace relume {

double Adaptation::plateau(size_t frames) const {
  return mean({mse.end() - static_cast<std::ptrdiff_t>(std::min(frames, mse.size())), mse.end()});
}

size_t Adaptation::adapted_after(double share, size_t window) const {
  const double goal = (1 + share) * plateau(mse.size() / 4);
  size_t after = mse.size();
  for (size_t begin = mse.size() - std::min(window, mse.size()) + 1; begin-- > 0;) {
    const auto from = mse.begin() + static_cast<std::ptrdiff_t>(begin);
    if (mean({from, from + static_cast<std::ptrdiff_t>(std::min(window, mse.size()))}) > goal) break;
    after = begin;
  }
  return after;
}

Adaptation measure_adaptation(const ExperimentContext& context, const std::string& name, Session& session, int runs,
                              int frames, const Reference& reference, const PictureRegion& region,
                              const std::function<void(Session&, int)>& before) {
  std::vector<std::vector<double>> by_frame(static_cast<size_t>(frames));
  Adaptation result{name, {}, {}, {}};
  const double noise = reference_noise(reference, region);
  for (int run = 0; run < runs; ++run) {
    session.restart(run + 1);
    for (int frame = 0; frame < frames; ++frame) {
      context.check_stop();
      if (before) before(session, frame);
      session.render_frame();
      by_frame[static_cast<size_t>(frame)].push_back(frame_mse(session.image(), reference.image, region) - noise);
    }
    context.report(name, (run + 1.0) / runs);
  }
  result.last = session.image();
  for (const std::vector<double>& values : by_frame) {
    result.mse.push_back(mean(values));
    result.standard_error.push_back(standard_deviation(values) / std::sqrt(static_cast<double>(values.size())));
  }
  return result;
}

ChartBlock adaptation_chart(std::string title, std::string text, const std::vector<Adaptation>& list, int first_frame) {
  Chart chart{.label = "MSE", .x_label = "frame", .y_label = "MSE", .log_x = false, .log_y = true, .curves = {}};
  int color = 0;
  for (const Adaptation& a : list) {
    Curve curve{.name = a.name, .color = color++, .dashed = false, .points = {}};
    for (size_t i = 0; i < a.mse.size(); ++i) {
      const double margin = 1.96 * a.standard_error[i];
      curve.points.push_back(
          {static_cast<double>(first_frame) + static_cast<double>(i), a.mse[i], a.mse[i] - margin, a.mse[i] + margin});
    }
    chart.curves.push_back(std::move(curve));
  }
  return {std::move(title), std::move(text), {std::move(chart)}};
}

}  // namespace relume
