// Figures from independent repetitions, with their noise.
#pragma once

#include <vector>

#include "relume/image_io.h"

namespace relume {

/// A figure, and what it is without each of several independent repetitions (the jackknife).
struct Estimate {
  double value = 0;
  std::vector<double> without;  ///< one a repetition

  /// Standard error; 0 below two repetitions. Of squared_bias() from n repetitions up to √(2 (n − 1) / (n − 2)) times
  /// too large where noise outweighs bias.
  double error() const;

  /// Half of the 95 % interval, by Student's t; 0 below two repetitions.
  double half_width() const;
};

/// Mean of one value a repetition.
Estimate mean_estimate(const std::vector<double>& values);

/// A multiple of it.
Estimate scaled(Estimate estimate, double factor);

/// a − b. If repetition i of both had one seed, the noise that they share does not count. Throws Error unless both have
/// equally many repetitions.
Estimate difference(const Estimate& a, const Estimate& b);

/// Mean square difference of what repetitions show on average from the reference, over pixels and channels. Noise adds
/// nothing to it on average: products of different repetitions alone count. `reference_mse`: the reference's own
/// expected MSE against the truth, which is taken off. Pixels that are not finite in all images are left out. Throws
/// Error below three repetitions, if the sizes differ, and if no pixel is left.
Estimate squared_bias(const std::vector<Image>& repetitions, const Image& reference, double reference_mse);

}  // namespace relume
