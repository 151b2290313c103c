// Error split into what more samples would remove and what they would not, from independent repetitions.
#pragma once

#include <cstdint>
#include <vector>

#include "io/image.h"

namespace relume {

/// Means over pixels and channels; expected MSE = bias² + variance.
struct ErrorSplit {
  double bias2 = 0;        ///< unbiased estimate; noise may make it slightly negative
  double bias2_error = 0;  ///< its standard error, from the spread between blocks of 16 × 16 pixels
  double variance = 0;     ///< of one repetition
  uint64_t pixels = 0;     ///< that are finite in all repetitions and in the reference
};

/// Mean and variance of each pixel over repetitions, updated one by one ([Welford62]).
class Ensemble {
 public:
  /// Throws Error unless all images have one size.
  void add(const Image& image);

  int count() const { return count_; }
  /// Mean of the repetitions.
  const Image& mean() const { return mean_; }

  /// Squared distance of a repetition from the reference at each pixel, mean over the repetitions. Throws Error without
  /// repetitions and if the sizes differ.
  Image squared_error(const Image& reference) const;

  /// `reference_mse`: the reference's own expected MSE against the truth, which its noise adds to the distance of the
  /// means and which is subtracted, as is the noise of the mean of the repetitions. Throws Error below two
  /// repetitions and if the sizes differ.
  ErrorSplit split(const Image& reference, double reference_mse = 0) const;

 private:
  int count_ = 0;
  Image mean_;
  std::vector<Rgb> m2_;
};

}  // namespace relume
