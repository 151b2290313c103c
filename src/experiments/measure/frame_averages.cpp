#include "experiments/measure/frame_averages.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/vec3.hpp>

#include "compare/timed_session.h"
#include "metrics/ensemble.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

/// Sums over frames, pixel by pixel.
struct FrameSums {
  std::vector<glm::dvec3> values;
  std::vector<glm::dvec3> squares;
  int count = 0;

  void add(const Image& image) {
    values.resize(image.pixels.size(), glm::dvec3(0));
    squares.resize(image.pixels.size(), glm::dvec3(0));
    for (size_t i = 0; i < image.pixels.size(); ++i) {
      const glm::dvec3 value(image.pixels[i]);
      values[i] += value;
      squares[i] += value * value;
    }
    ++count;
  }

  /// Variance of a frame, unbiased if frames are independent; mean over pixels and channels.
  double variance() const {
    double sum = 0;
    for (size_t i = 0; i < values.size(); ++i) {
      const glm::dvec3 v = squares[i] - values[i] * values[i] / static_cast<double>(count);
      sum += v.x + v.y + v.z;
    }
    return sum / (3.0 * static_cast<double>(values.size()) * std::max(1, count - 1));
  }
};

Image mean_image(const std::vector<glm::dvec3>& sums, int count, int width, int height) {
  Image image(width, height);
  for (size_t i = 0; i < sums.size(); ++i) image.pixels[i] = Rgb(sums[i] / static_cast<double>(count));
  return image;
}

double mean_termination(const Session& session) {
  if (session.settings().cache == CacheChoice::none) return 0;
  double sum = 0;
  const View<const float> layer = session.buffers().view<const float>("cell-termination");
  for (const float bounce : layer) sum += static_cast<double>(bounce);
  return sum / static_cast<double>(layer.size);
}

}  // namespace

FrameAverages average_frames(const ExperimentContext& context, const ExperimentScene& scene,
                             const NamedSettings& contender, const FramePlanOfAverages& plan,
                             const Reference& reference) {
  TimedSession session(scene.scene, contender.settings);
  session.session().set_camera(scene.camera);
  std::vector<Image> means;
  std::vector<double> variances;
  FrameAverages result{.name = contender.name};
  std::vector<double> frame_s;
  for (int repetition = 0; repetition < plan.repetitions; ++repetition) {
    session.restart(1 + repetition);
    FrameSums sums;
    for (int frame = 0; frame < plan.skip + plan.count; ++frame) {
      context.check_stop();
      session.render_frame();
      if (frame < plan.skip) continue;
      sums.add(session.session().image());
      result.termination += mean_termination(session.session());
    }
    frame_s.insert(frame_s.end(), session.frame_s().begin() + plan.skip, session.frame_s().end());
    means.push_back(mean_image(sums.values, sums.count, contender.settings.width, contender.settings.height));
    variances.push_back(sums.variance());
    context.report(fmt::format("{}, {}", scene.name, contender.name), (repetition + 1.0) / plan.repetitions);
  }
  result.bias2 = squared_bias(means, reference.image, reference.mse);
  result.variance = mean_estimate(variances);
  result.termination /= plan.count * plan.repetitions;
  result.frame_s = median(std::move(frame_s));
  Ensemble ensemble;
  for (const Image& mean : means) ensemble.add(mean);
  result.average = ensemble.mean();
  return result;
}

}  // namespace relume
