// Comparison of estimators by the means of whole images.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "techniques/transport/bdpt/testing/bdpt_frame.h"

namespace relume::testing {

/// Mean over all pixels, and its variance estimated from samples of whole images.
struct ImageMean {
  glm::dvec3 value{0};
  glm::dvec3 variance{0};  ///< of `value`, an upper estimate that ignores stratification
};

inline ImageMean mean_of(const Scene& scene, const BdptOptions& options, int spp) {
  BdptFrame frame(Scene(scene), options);
  glm::dvec3 sum(0);
  glm::dvec3 squares(0);
  for (int i = 0; i < spp; ++i) {
    frame.run(0, static_cast<uint32_t>(i));
    glm::dvec3 mean(0);
    for (const Rgb& p : frame.radiance) mean += glm::dvec3(p) / static_cast<double>(frame.radiance.size());
    sum += mean;
    squares += mean * mean;
  }
  const double n = spp;
  return {sum / n, (squares / n - sum * sum / (n * n)) / n};
}

inline void expect_same_mean(const ImageMean& a, const ImageMean& b, const std::string& name) {
  constexpr double kStandardErrors = 5;
  for (int c = 0; c < 3; ++c) {
    const double tolerance = kStandardErrors * std::sqrt(a.variance[c] + b.variance[c]);
    EXPECT_NEAR(a.value[c], b.value[c], tolerance) << name << ", channel " << c;
  }
}

inline const BdptOptions kCameraAlone{.max_light_vertices = 1};

/// Expects equal means from camera paths, bidirectional paths and light paths.
inline void expect_agreement(const Scene& scene, const std::string& name, int samples = 512) {
  const ImageMean camera_alone = mean_of(scene, kCameraAlone, samples);
  expect_same_mean(mean_of(scene, {}, samples), camera_alone, name);
  expect_same_mean(mean_of(scene, {.light_only = true}, samples), camera_alone, name + ", light alone");
}

}  // namespace relume::testing
