// Error split into what differs between independent repetitions and what they have in common.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "relume/image_io.h"

namespace relume {

/// Means over pixels and channels; expected MSE = bias² + variance.
struct ErrorSplit {
  double bias2 = 0;                        ///< unbiased estimate; noise may make it slightly negative
  std::optional<double> bias2_error = {};  ///< its standard error; not known below three repetitions
  double variance = 0;                     ///< of one repetition
  uint64_t pixels = 0;                     ///< that are finite in all repetitions and in the reference
};

/// Mean and variance of each pixel over repetitions, updated one by one ([Welford62]).
class Ensemble {
 public:
  /// Throws Error unless all images have one size.
  void add(const Image& image);

  int count() const { return count_; }
  /// Mean of the repetitions.
  const Image& mean() const { return mean_; }

  /// `reference_mse`: the reference's own expected MSE against the truth, which its noise adds to the distance of the
  /// means and which is subtracted, as is the noise of the mean of the repetitions. The error of bias² is that of the
  /// repetitions' noise, whatever the bias looks like over the image (squared_bias()); what chance there is in the
  /// reference's noise is not in it. Throws Error below two repetitions and if the sizes differ.
  ErrorSplit split(const Image& reference, double reference_mse = 0) const;

 private:
  void add_to_group(const Image& image);

  int count_ = 0;
  Image mean_;
  std::vector<Rgb> m2_;
  std::vector<Image> groups_;  ///< means of every eighth repetition, so that memory does not grow with their number
};

}  // namespace relume
