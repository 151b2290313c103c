// Figures from independent repetitions, with their noise, and verdicts that noise alone does not decide.
#pragma once

#include <string>
#include <vector>

#include "io/image.h"
#include "report/page.h"

namespace relume {

/// A figure, and what it is without each of several independent repetitions (the jackknife).
struct Estimate {
  double value = 0;
  std::vector<double> without;  ///< one a repetition

  /// Standard error; 0 below two repetitions. Of squared_bias() up to 1.6 times too large where noise outweighs bias.
  double error() const;
};

/// Mean of one value a repetition.
Estimate mean_estimate(const std::vector<double>& values);

/// A multiple of it.
Estimate scaled(Estimate estimate, double factor);

/// a − b. If repetition i of both had one seed, the noise that they share does not count.
Estimate difference(const Estimate& a, const Estimate& b);

/// Mean square difference of what repetitions show on average from the reference, over pixels and channels. Noise adds
/// nothing to it on average: products of different repetitions alone count. `reference_mse`: the reference's own
/// expected MSE against the truth, which is taken off. Throws Error below three repetitions and if the sizes differ.
Estimate squared_bias(const std::vector<Image>& repetitions, const Image& reference, double reference_mse);

/// Whether something is negative: beyond two standard errors it is, or it is not; else that is undecided.
const char* verdict_below(const Estimate& difference);

/// "0.0012 ± 0.0001": two standard errors.
std::string with_noise(const Estimate& estimate);

}  // namespace relume
