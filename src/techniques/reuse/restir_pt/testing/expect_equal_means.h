// Comparison of images by their means over seeds.
#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "techniques/reuse/restir_gi/testing/image_means.h"

namespace relume::testing {

/// Compares the mean of the image, then those of its blocks, which show darkening at edges. `most_error`: of the image,
/// relative. `bias`: of the image, relative.
inline void expect_equal(const std::vector<Measured>& reused, const std::vector<Measured>& truth,
                         double most_error = 0.02, double bias = 0) {
  EXPECT_LT(error_of(reused[0], truth[0]), most_error * truth[0].mean);
  for (size_t k = 0; k < (bias > 0 ? size_t{1} : truth.size()); ++k) {
    // With few degrees of freedom, standard errors are uncertain.
    const double tolerance = bias * truth[k].mean + (k == 0 ? 6 : 7) * error_of(reused[k], truth[k]) + 1e-6;
    EXPECT_NEAR(reused[k].mean, truth[k].mean, tolerance) << (k == 0 ? "image" : "block ") << k;
  }
}

}  // namespace relume::testing
