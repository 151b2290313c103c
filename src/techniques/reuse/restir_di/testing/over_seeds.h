// Means over runs with different seeds, for tests of estimates whose frames and pixels depend on each other.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace relume::testing {

/// A mean over independent runs, and its standard error.
struct Measured {
  double mean = 0;
  double error = 0;
};

/// Requires at least two values.
inline Measured measured_over(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0;
  double squares = 0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(squares / n - mean * mean, 0.0) / (n - 1))};
}

/// The mean of `value_of` for the seeds 1, 2, …
template <typename Value>
Measured mean_over_seeds(int seeds, const Value& value_of) {
  std::vector<double> values;
  for (int seed = 1; seed <= seeds; ++seed) values.push_back(value_of(seed));
  return measured_over(values);
}

inline double deviation(const Measured& a, const Measured& b) { return a.mean - b.mean; }
inline double error_of(const Measured& a, const Measured& b) { return std::hypot(a.error, b.error); }

}  // namespace relume::testing
