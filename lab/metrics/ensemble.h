// Splits error into the part that varies between independent repetitions and the part that they share.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "relume/image_io.h"

namespace relume {

/// Means over pixels and channels; expected MSE = bias² + variance.
struct ErrorSplit {
  double bias2 = 0;                        ///< unbiased estimate; noise may make it slightly negative
  std::optional<double> bias2_error = {};  ///< its standard error; unknown below three repetitions
  double variance = 0;                     ///< of one repetition
  uint64_t pixels = 0;                     ///< number of pixels that are finite in all repetitions and in the reference
};

/// Mean and variance of each pixel over repetitions, updated per repetition ([Welford62]).
class Ensemble {
 public:
  /// Throws Error unless all images have equal size.
  void add(const Image& image);

  int count() const { return count_; }
  /// Mean of the repetitions.
  const Image& mean() const { return mean_; }

  /// Splits the error. Subtracts `reference_mse`, the reference's expected MSE against the true image, and the noise of
  /// the mean. The error of bias² covers the repetitions' noise (squared_bias()), but not the reference's. Throws Error
  /// below two repetitions and if the sizes differ.
  ErrorSplit split(const Image& reference, double reference_mse = 0) const;

 private:
  void add_to_group(const Image& image);

  int count_ = 0;
  Image mean_;
  std::vector<Rgb> m2_;
  std::vector<Image> groups_;  ///< means of every eighth repetition, to bound memory
};

}  // namespace relume
