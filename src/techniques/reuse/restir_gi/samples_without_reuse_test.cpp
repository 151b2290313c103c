// Without reuse, each pixel adds its own sample of indirect light. Frames of bidirectional estimators then have the
// mean of the same frames without reservoirs. The random numbers are the same, too, so differences of frames have
// little noise: their mean is known to fractions of a percent, where a comparison with path tracing has several.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"
#include "techniques/reuse/restir_gi/testing/large_lamps.h"

namespace relume {
namespace {

using testing::Measured;
using testing::measured_over;
using testing::under_large_lamps;

constexpr int kSize = 64;
constexpr float kRadius = 0.02f;  ///< of merging: with one light subpath per pixel, mergings find much of the light
constexpr size_t kLeastFrames = 12;
constexpr size_t kMostFrames = 128;
constexpr double kMostError = 0.0025;      ///< standard error of the difference, relative to the mean
constexpr double kMostGlassError = 0.006;  ///< the same with caustics on second vertices
constexpr double kBiasOfVcm = 0.01;        ///< second vertices blur light in place of primary hits

/// The Cornell box, whose surfaces are Lambertian below a smooth boundary that reflects 36 % at normal incidence.
/// Second vertices scatter light of both kinds.
Scene polished_cornell() {
  Scene scene = find_builtin_scene("cornell")->build();
  for (Material& m : scene.materials) {
    if (!is_black(m.emission)) continue;
    m.metallic = 0;
    m.specular = 1;
    m.roughness = 0;
    m.ior = 4;
  }
  return scene;
}

RenderSettings settings_of(EstimatorChoice estimator) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.estimator = estimator;
  settings.vcm.radius = kRadius;
  settings.restir_gi.cap = settings.restir_gi.neighbours = 0;
  settings.path.max_bounces = 4;
  settings.history = HistoryChoice::none;  // frames are independent
  return settings;
}

double mean_of_next_frame(Session& session) {
  session.render_frame();
  double sum = 0;
  const Image image = session.image();
  for (const Rgb& pixel : image.pixels) sum += static_cast<double>(luminance(pixel));
  return sum / static_cast<double>(image.pixels.size());
}

/// Compares the means of frames with and without reservoirs. Adds frames until the standard error is low enough.
void expect_same_mean(const Scene& scene, EstimatorChoice estimator, double most_error) {
  RenderSettings settings = settings_of(estimator);
  Session plain(Scene(scene), settings);
  settings.reuse = ReuseChoice::restir_gi;
  Session sampled(Scene(scene), settings);
  std::vector<double> means;
  std::vector<double> differences;
  while (means.size() < kMostFrames) {
    means.push_back(mean_of_next_frame(plain));
    differences.push_back(mean_of_next_frame(sampled) - means.back());
    if (means.size() < kLeastFrames) continue;
    if (measured_over(differences).error < most_error * measured_over(means).mean) break;
  }
  const double mean = measured_over(means).mean;
  const Measured difference = measured_over(differences);
  EXPECT_GT(mean, 0);
  EXPECT_LE(difference.error, most_error * mean);
  const double bias = estimator == EstimatorChoice::vcm ? kBiasOfVcm : 0;
  EXPECT_NEAR(difference.mean, 0, 5 * difference.error + bias * mean);
}

/// Fails if light that a second vertex scatters by a delta lobe keeps the weights or the throughput of the sample, or
/// if splats leave it out: all three change light that is many times the tolerance.
TEST(SamplesWithoutReuse, HaveTheMeanOfBdptOnPolishedSurfaces) {
  expect_same_mean(polished_cornell(), EstimatorChoice::bdpt, kMostError);
}

/// Fails if primary hits merge with vertices that density lobes found, or do not merge with those that delta lobes
/// found.
TEST(SamplesWithoutReuse, HaveTheMeanOfVcmOnPolishedSurfaces) {
  expect_same_mean(polished_cornell(), EstimatorChoice::vcm, kMostError);
}

/// Delta lobes alone scatter at the second vertices of caustics, so these vertices have no samples.
TEST(SamplesWithoutReuse, HaveTheMeanOfVcmBehindGlass) {
  expect_same_mean(under_large_lamps("cornell-glass"), EstimatorChoice::vcm, kMostGlassError);
}

TEST(SamplesWithoutReuse, HaveTheMeanOfBdptBelowWater) {
  expect_same_mean(under_large_lamps("cornell-water"), EstimatorChoice::bdpt, kMostGlassError);
}

}  // namespace
}  // namespace relume
