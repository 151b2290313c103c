#include "combinations/means.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "core/array.h"
#include "core/vec.h"
#include "render/session.h"
#include "support/measure.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

constexpr int kFramesBefore = 8;  // before the camera moves
constexpr int kFrames = 24;       // after the camera moved
constexpr int kMostSeeds = 2000;

/// Means over the second half of `frames` images after a sideways move of the camera from `start`, so that histories
/// are reprojected.
Means means_after_a_move(Session& session, const CameraPose& start, int frames) {
  for (int i = 0; i < kFramesBefore; ++i) session.render_frame();
  CameraPose camera = start;
  camera.to_world[3] += 0.1f * camera.to_world[0];
  session.set_camera(camera);
  const int first = frames / 2;
  Means means = {};
  for (int i = 0; i < frames; ++i) {
    session.render_frame();
    if (i < first) continue;
    const Rgb mean = estimate_of(session.image()).mean;
    const float values[kMeans] = {luminance(mean), mean.r, mean.g, mean.b};
    for (int m = 0; m < kMeans; ++m) means[m] += static_cast<double>(values[m]) / (frames - first);
  }
  EXPECT_EQ(session.statistics().nonfinite_samples, 0u);
  return means;
}

/// Images of seeds 1, 2, …, rendered on demand by one session.
class Measurement {
 public:
  Measurement(Session session, int frames) : session_(std::move(session)), start_(session_.camera()), frames_(frames) {}

  /// Mean over `seeds` images, or all rendered ones if there are more.
  Mean over(int seeds) {
    while (seeds_ < seeds) {
      session_.set_camera(start_);
      session_.restart(++seeds_);
      const Means means = means_after_a_move(session_, start_, frames_);
      for (int m = 0; m < kMeans; ++m) {
        sums_[m] += means[m];
        squares_[m] += means[m] * means[m];
      }
    }
    const double n = seeds_;
    Mean mean{.seeds = seeds_};
    for (int m = 0; m < kMeans; ++m) {
      mean.value[m] = sums_[m] / n;
      mean.error[m] = std::sqrt(std::max(0.0, squares_[m] / n - mean.value[m] * mean.value[m]) / (n - 1));
    }
    return mean;
  }

 private:
  Session session_;
  CameraPose start_;
  int frames_;
  int seeds_ = 0;
  Means sums_ = {};
  Means squares_ = {};
};

Mean mean_of_path_tracing(int max_bounces, int frames, int seeds) {
  RenderSettings settings = small_settings(kSize, kSize);
  settings.path.max_bounces = max_bounces;
  return Measurement(make_session(open_box(), settings, host_memory()), frames).over(seeds);
}

/// Relative deviation of one of the means, with the degrees of freedom of its error by Welch and Satterthwaite.
Deviation deviation_of(const Mean& mean, const Mean& truth, int m) {
  const double error = mean.error[m] / truth.value[m];
  const double truth_error = truth.error[m] / truth.value[m];
  const double a = error * error;
  const double b = truth_error * truth_error;
  const double spread = a * a / (mean.seeds - 1) + b * b / (truth.seeds - 1);
  return {mean.value[m] / truth.value[m] - 1, std::hypot(error, truth_error),
          spread > 0 ? (a + b) * (a + b) / spread : static_cast<double>(mean.seeds - 1)};
}

}  // namespace

const Mean& reference(int max_bounces, ReferenceLength length) {
  static std::map<std::pair<int, ReferenceLength>, Mean> known;
  const auto [found, is_new] = known.try_emplace({max_bounces, length});
  if (!is_new) return found->second;
  const bool is_default = max_bounces == RenderSettings{}.path.max_bounces;
  switch (length) {
    case ReferenceLength::whole: found->second = mean_of_path_tracing(max_bounces, 256, is_default ? 32 : 12); break;
    case ReferenceLength::quarter: found->second = mean_of_path_tracing(max_bounces, 128, is_default ? 16 : 8); break;
  }
  return found->second;
}

RenderSettings scaled(RenderSettings settings) {
  settings.static_lists.rays = 64;  // their preparation would dominate the test's time
  settings.static_lists.cell_size = 0.5f;
  settings.octree.collapse = 32;  // many regions for few pixels
  settings.octree.split = 64;
  settings.octree.scale = false;
  return settings;
}

Deviations measure_deviations(const RenderSettings& settings, const Mean& truth, double most_error, int least_seeds) {
  Measurement measurement(Session(open_box(), settings), kFrames);
  Deviations deviations;
  for (int seeds = least_seeds; seeds <= kMostSeeds; seeds += seeds / 4) {
    const Mean mean = measurement.over(seeds);
    for (int m = 0; m < kMeans; ++m) deviations[m] = deviation_of(mean, truth, m);
    if (deviations[0].error <= most_error) break;
  }
  return deviations;
}

std::string describe_problem(const Deviations& deviations, double bias, double most_error, NoiseLimit limit) {
  if (deviations[0].error > most_error)
    return fmt::format("a standard error of {:.2f} % says too little", 100 * deviations[0].error);
  for (const Deviation& d : deviations) {
    if (std::fabs(d.value) <= bias + limit(d) * d.error) continue;
    return fmt::format("{:+.2f} % with a standard error of {:.2f} %", 100 * d.value, 100 * d.error);
  }
  return {};
}

}  // namespace relume::support
