// Do two ways to render show the same picture? Statistical tests over many independently seeded images of each.
#pragma once

#include <string>
#include <vector>

#include "support/measure.h"

namespace relume::support {

struct ImageTestOptions {
  /// Probability of rejecting equal pictures, for each of the two tests: 1 % over the hundred or so comparisons of the
  /// whole suite, 1 − 0.99^(1/100). Seeds are fixed, so a test that passes keeps passing until the code changes.
  double significance = 1e-4;
  /// Whether pixels count, not only blocks. Not where one side finds light so rarely that most of its images lack it:
  /// the spread of 16 images says nothing of such a pixel then.
  bool pixels = true;
  int block_size = 16;
  double block_tolerance = 0.005;  ///< of a block's mean
  /// What the test must be able to tell: the most that `resolution` may be. Larger errors would hide.
  double resolution = 0.2;
};

struct ImageTest {
  std::vector<float> p;  ///< least p-value of a pixel's channels
  double least_p = 1;
  double pixel_threshold = 0;  ///< Šidák: 1 − (1 − significance)^(1 / number of pixels and channels)
  int rejected_pixels = 0;
  double worst_block = 0;       ///< relative difference of means
  double block_resolution = 0;  ///< largest relative standard error of a block's difference
  double resolution = 0;        ///< relative standard error of a block's difference, averaged by the blocks' light
  int rejected_blocks = 0;

  bool agree() const { return rejected_pixels == 0 && rejected_blocks == 0; }
  std::string report() const;
};

/// Welch's t-test in every pixel and channel, two-sided, and means of blocks: a block is rejected if it differs by more
/// than the tolerance and by more than chance explains (Welch and Šidák again). At least 16 images a side.
ImageTest compare(const Moments& a, const Moments& b, const ImageTestOptions& options = {});

/// Expects agreement; otherwise writes both pictures (EXR) and the map of p-values (PNG, black: 1, bright: rejected) as
/// NAME-*.exr and NAME-p.png in the folder of test results, and says where they are.
void expect_same_picture(const std::string& name, const Moments& a, const Moments& b,
                         const ImageTestOptions& options = {});

/// P(|T| ≥ |t|) for Student's distribution with `degrees` > 0 degrees of freedom (NIST DLMF §8.17).
double student_two_sided_p(double t, double degrees);

}  // namespace relume::support
