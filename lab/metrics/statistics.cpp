#include "metrics/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace relume {
namespace {

/// Probability that exactly `k` of `n` fair coins show heads. Uses logarithms because 2^-n underflows from about n =
/// 1000.
double binomial(size_t n, size_t k) {
  const auto log_factorial = [](size_t i) { return std::lgamma(static_cast<double>(i) + 1); };
  return std::exp(log_factorial(n) - log_factorial(k) - log_factorial(n - k) - static_cast<double>(n) * std::log(2.0));
}

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

Interval median_interval(std::vector<double> values, double confidence) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  size_t k = 1;                   // the pair is the k-th smallest and the k-th largest value
  double below = binomial(n, 0);  // probability that fewer than k values lie below the median
  for (double next = below + binomial(n, k); 2 * (k + 1) <= n && 1 - 2 * next >= confidence; next += binomial(n, k)) {
    below = next;
    ++k;
  }
  return {values[k - 1], values[n - k], n < 2 ? 0 : 1 - 2 * below};
}

double student_t(size_t degrees_of_freedom) {
  constexpr std::array<double, 10> kSmall{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
  if (degrees_of_freedom <= kSmall.size()) return kSmall[degrees_of_freedom - 1];
  const double v = static_cast<double>(degrees_of_freedom);
  return 1.95996 * (1 + 1.2104 / v + 1.4402 / (v * v));  // Cornish-Fisher: accurate to 0.2 % from 11 on
}

double mean(const std::vector<double>& values) {
  if (values.empty()) return 0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double standard_deviation(const std::vector<double>& values) {
  if (values.size() < 2) return 0;
  const double m = mean(values);
  double sum = 0;
  for (double x : values) sum += (x - m) * (x - m);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

Interval mean_interval(const std::vector<double>& values) {
  const double m = mean(values);
  if (values.size() < 2) return {m, m, 0};
  const double half = student_t(values.size() - 1) * standard_deviation(values) / std::sqrt(double(values.size()));
  return {m - half, m + half, 0.95};
}

}  // namespace relume
