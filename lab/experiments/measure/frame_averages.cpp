#include "experiments/measure/frame_averages.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "experiments/shared_parts.h"
#include "metrics/ensemble.h"
#include "render/session.h"
#include "techniques/radiance_cache/path_space_filter/cells_pass.h"

namespace relume {
namespace {

Image mean_image(const std::vector<glm::dvec3>& sums, int count, int width, int height) {
  Image image(width, height);
  for (size_t i = 0; i < sums.size(); ++i) image.pixels[i] = Rgb(sums[i] / static_cast<double>(count));
  return image;
}

double mean_light(const Image& image) {
  double sum = 0;
  for (const Rgb& pixel : image.pixels)
    sum += static_cast<double>(pixel.r) + static_cast<double>(pixel.g) + static_cast<double>(pixel.b);
  return sum / (3.0 * static_cast<double>(image.pixels.size()));
}

double mean_termination(const Session& session) {
  if (render_settings(session).cache == CacheChoice::none) return 0;
  double sum = 0;
  const View<const float> layer = buffer_table(session).view(kCellTermination);
  for (const float bounce : layer) sum += static_cast<double>(bounce);
  return sum / static_cast<double>(layer.size);
}

}  // namespace

void FrameSums::add(const Image& image) {
  values.resize(image.pixels.size(), glm::dvec3(0));
  squares.resize(image.pixels.size(), 0);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const glm::dvec3 value(image.pixels[i]);
    values[i] += value;
    squares[i] += glm::dot(value, value);
  }
  ++count;
}

Estimate frame_variance(const std::vector<FrameSums>& repetitions, const PixelMask& region) {
  const auto n = static_cast<double>(repetitions.size());
  std::vector<double> squares(repetitions.size(), 0.0);  // mean over frames, sum over pixels
  double crossed = 0;                                    // Σ over pairs of repetitions
  std::vector<double> crossed_without(repetitions.size(), 0.0);
  for (size_t p = 0; p < region.mask.size(); ++p) {
    if (region.mask[p] == 0) continue;
    glm::dvec3 sum(0);
    double own = 0;
    for (size_t r = 0; r < repetitions.size(); ++r) {
      const glm::dvec3 mean = repetitions[r].values[p] / static_cast<double>(repetitions[r].count);
      sum += mean;
      own += glm::dot(mean, mean);
      squares[r] += repetitions[r].squares[p] / repetitions[r].count;
    }
    crossed += glm::dot(sum, sum) - own;
    for (size_t r = 0; r < repetitions.size(); ++r) {
      const glm::dvec3 mean = repetitions[r].values[p] / static_cast<double>(repetitions[r].count);
      crossed_without[r] += glm::dot(sum - mean, sum - mean) - (own - glm::dot(mean, mean));
    }
  }
  const double values = 3.0 * static_cast<double>(region.pixels());
  const Estimate mean_square = mean_estimate(squares);
  Estimate result{(mean_square.value - crossed / (n * (n - 1))) / values, {}};
  for (size_t r = 0; r < repetitions.size(); ++r)
    result.without.push_back((mean_square.without[r] - crossed_without[r] / ((n - 1) * (n - 2))) / values);
  return result;
}

FrameAverages average_frames(const ExperimentContext& context, const ExperimentScene& scene,
                             const NamedSettings& contender, const FramePlanOfAverages& plan,
                             const Reference& reference, const PixelMask& surfaces) {
  std::optional<Session> session;  // of a rank that measures
  const auto measure = [&](const ExperimentContext& own, int repetition) {
    if (!session) session.emplace(scene.scene, contender.settings).set_camera(scene.camera);
    session->restart(1 + repetition);
    std::pair<FrameSums, double> measured;  // with the mean termination
    for (int frame = 0; frame < plan.skip + plan.count; ++frame) {
      own.check_stop();
      session->render_frame();
      if (frame < plan.skip) continue;
      measured.first.add(session->image());
      measured.second += mean_termination(*session) / plan.count;
    }
    return measured;
  };
  FrameAverages result{.name = contender.name};
  std::vector<Image> means;
  std::vector<FrameSums> repetitions;
  std::vector<double> terminations;
  const std::string stage = fmt::format("{}, {}", scene.name, contender.name);
  for (auto& [sums, termination] : deal_parts(context, stage, plan.repetitions, measure)) {
    means.push_back(mean_image(sums.values, sums.count, contender.settings.width, contender.settings.height));
    result.light.push_back(mean_light(means.back()));
    repetitions.push_back(std::move(sums));
    terminations.push_back(termination);
  }
  result.bias2 = squared_bias(means, reference.image, reference.mse);
  result.variance =
      frame_variance(repetitions, mask_of({"image"}, contender.settings.width, contender.settings.height));
  result.surface_variance = frame_variance(repetitions, surfaces);
  result.termination = mean_estimate(terminations);
  Ensemble ensemble;
  for (const Image& mean : means) ensemble.add(mean);
  result.average = ensemble.mean();
  return result;
}

}  // namespace relume
