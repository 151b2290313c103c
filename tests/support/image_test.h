// Do two ways to render show the same image? Statistical tests over many independently seeded images of each.
#pragma once

#include <string>
#include <vector>

#include "support/measure.h"

namespace relume::support {

/// A comparison that notices errors of a block from here on only is not worth making.
inline constexpr double kMostDetectable = 0.6;

struct ImageTestOptions {
  /// Probability of rejecting equal images, for each of the three tests: 1 % over the hundred or so comparisons of
  /// the whole suite, 1 − 0.99^(1/100). Seeds are fixed, so a test that passes keeps passing until the code changes.
  double significance = 1e-4;
  /// Whether pixels count, not only blocks. Not where one side finds light so rarely that most of its images lack it:
  /// the spread of 16 images says nothing of such a pixel then.
  bool pixels = true;
  int block_size = 16;
  double tolerance = 0.005;  ///< of the mean of a block or the image
  /// What the test must be able to tell: the most that `detectable` (below kMostDetectable) and `detectable_mean` of
  /// ImageTest may be.
  double detectable = 0.1;
  double detectable_mean = 0.05;
};

struct ImageTest {
  std::vector<float> p;  ///< least p-value of a pixel's channels
  double least_p = 1;
  double pixel_threshold = 0;  ///< Šidák: 1 − (1 − significance)^(1 / number of pixels and channels)
  int rejected_pixels = 0;
  double worst_block = 0;  ///< relative difference of means
  int rejected_blocks = 0;
  double worst_mean = 0;  ///< the same of the whole image, a channel
  int rejected_means = 0;
  /// The relative error from which on a block is rejected, averaged by the blocks' light, and the whole image's mean:
  /// smaller ones hide. Infinite where there is no light.
  double detectable = 0;
  double detectable_mean = 0;

  bool agree() const { return rejected_pixels == 0 && rejected_blocks == 0 && rejected_means == 0; }
  std::string report() const;
};

/// Welch's t-test in every pixel and channel, two-sided, and of means over blocks and over the image: those are
/// rejected if they differ by more than the tolerance and by more than chance explains (Welch and Šidák again). At
/// least 16 images a side.
ImageTest compare(const Moments& a, const Moments& b, const ImageTestOptions& options = {});

/// Expects agreement; otherwise writes both images (EXR) and the map of p-values (PNG, black: 1, bright: rejected) as
/// NAME-*.exr and NAME-p.png in the folder of test results, and says where they are.
void expect_same_image(const std::string& name, const Moments& a, const Moments& b,
                       const ImageTestOptions& options = {});

/// P(|T| ≥ |t|) for Student's distribution with `degrees` > 0 degrees of freedom (NIST DLMF §8.17).
double student_two_sided_p(double t, double degrees);
/// The t > 0 with that probability p in (0, 1).
double student_two_sided_quantile(double p, double degrees);

}  // namespace relume::support
