// Statistics of few repeated measurements.
#pragma once

#include <cstddef>
#include <vector>

namespace relume {

/// Bounds that contain the true value with probability `confidence`.
struct Interval {
  double low = 0;
  double high = 0;
  double confidence = 0;
};

/// Middle value; mean of the two middle ones for an even count. 0 without values.
double median(std::vector<double> values);

/// Distribution-free interval of the median between order statistics: the narrowest symmetric pair with at least
/// `confidence`, or else the whole range, with confidence 1 - 2^(1 - n).
Interval median_interval(std::vector<double> values, double confidence = 0.95);

/// Interval of the mean of normally distributed values, by Student's t at 95 %. A single value has confidence 0.
Interval mean_interval(const std::vector<double>& values);

/// Quantile 0.975 of Student's t distribution. Requires at least one degree of freedom.
double student_t(size_t degrees_of_freedom);

double mean(const std::vector<double>& values);
/// Root of the unbiased variance; 0 below two values.
double standard_deviation(const std::vector<double>& values);

}  // namespace relume
