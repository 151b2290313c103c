// Measured values from independent repetitions, with their noise.
#pragma once

#include <vector>

#include "relume/image_io.h"

namespace relume {

/// A value, and its jackknife estimates without each of several independent repetitions.
struct Estimate {
  double value = 0;
  std::vector<double> without;  ///< one per repetition

  /// Standard error; 0 below two repetitions. For squared_bias() from n repetitions, up to √(2 (n − 1) / (n − 2)) times
  /// too large if noise outweighs bias.
  double error() const;

  /// Half of the 95 % interval, by Student's t; 0 below two repetitions.
  double half_width() const;
};

/// Mean of one value per repetition.
Estimate mean_estimate(const std::vector<double>& values);

/// Multiplies the estimate by `factor`.
Estimate scaled(Estimate estimate, double factor);

/// a − b. If repetition i of both used the same seed, their shared noise cancels. Throws Error unless both have the
/// same number of repetitions.
Estimate difference(const Estimate& a, const Estimate& b);

/// Mean squared difference between the repetitions' expected image and the reference, over pixels and channels. Noise
/// does not bias it, because only products of different repetitions contribute. Subtracts `reference_mse`, the
/// reference's expected MSE against the true image. Excludes pixels that are not finite in every image. Throws Error
/// below three repetitions, if the sizes differ, and if no pixel remains.
Estimate squared_bias(const std::vector<Image>& repetitions, const Image& reference, double reference_mse);

}  // namespace relume
