// Statistical tests of whether two techniques render the same image, over many independently seeded images of each.
#pragma once

#include <string>
#include <vector>

#include "support/measure.h"

namespace relume::support {

/// Upper limit of a block's detectable relative error: less sensitive comparisons are useless.
inline constexpr double kMostDetectable = 0.6;

struct ImageTestOptions {
  /// Probability of rejecting equal images, for each of the three tests: 1 % over the about one hundred comparisons of
  /// the whole suite, 1 − 0.99^(1/100). Seeds are fixed, so a passing test keeps passing until the code changes.
  double significance = 1e-4;
  /// Whether pixels are tested in addition to blocks. Disable if one side's light is so rare that most of its images
  /// lack it: 16 images do not determine the variance of such a pixel.
  bool pixels = true;
  int block_size = 16;
  double tolerance = 0.005;  ///< relative to the mean of a block or the image
  /// Required sensitivity: upper limits of `detectable` (below kMostDetectable) and `detectable_mean` of ImageTest.
  double detectable = 0.1;
  double detectable_mean = 0.05;
};

struct ImageTest {
  std::vector<float> p;  ///< lowest p-value of a pixel's channels
  double least_p = 1;
  double pixel_threshold = 0;  ///< Šidák: 1 − (1 − significance)^(1 / number of pixels and channels)
  int rejected_pixels = 0;
  double worst_block = 0;  ///< relative difference of means
  int rejected_blocks = 0;
  double worst_mean = 0;  ///< same for the whole image, per channel
  int rejected_means = 0;
  /// Relative errors at which a block (weighted by the blocks' radiance) and the whole image's mean are rejected;
  /// smaller ones are not detected. Infinite without light.
  double detectable = 0;
  double detectable_mean = 0;

  bool agree() const { return rejected_pixels == 0 && rejected_blocks == 0 && rejected_means == 0; }
  std::string report() const;
};

/// Two-sided Welch's t-test for every pixel and channel, and for means over blocks and the image. Means are rejected if
/// they differ by more than the tolerance and significantly (also Welch and Šidák). Requires at least 16 images per
/// side.
ImageTest compare(const Moments& a, const Moments& b, const ImageTestOptions& options = {});

/// Expects agreement. On failure, writes both images (EXR) and the map of p-values (PNG, black: 1, bright: rejected) as
/// NAME-*.exr and NAME-p.png to the folder of test results, and reports their paths.
void expect_same_image(const std::string& name, const Moments& a, const Moments& b,
                       const ImageTestOptions& options = {});

/// P(|T| ≥ |t|) for Student's distribution with `degrees` > 0 degrees of freedom (NIST DLMF §8.17).
double student_two_sided_p(double t, double degrees);
/// Positive t for probability p in (0, 1).
double student_two_sided_quantile(double p, double degrees);

}  // namespace relume::support
