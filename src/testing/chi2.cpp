#include "testing/chi2.h"

#include <cmath>

namespace relume::testing {
namespace {

constexpr double kPrecision = 1e-12;
constexpr int kMaxTerms = 100000;

/// Regularised lower incomplete gamma function by its series (NIST DLMF, 8.11.4); for x < a + 1.
double lower_by_series(double a, double x) {
  double term = 1.0 / a;
  double sum = term;
  for (int n = 1; n < kMaxTerms && term > sum * kPrecision; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * std::exp(a * std::log(x) - x - std::lgamma(a));
}

/// Regularised upper incomplete gamma function by its continued fraction (NIST DLMF, 8.9.2), evaluated forwards by
/// Lentz's method; for x ≥ a + 1.
double upper_by_fraction(double a, double x) {
  constexpr double kTiny = 1e-300;
  double b = x + 1.0 - a;
  double c = 1.0 / kTiny;
  double d = 1.0 / b;
  double value = d;
  for (int n = 1; n < kMaxTerms; ++n) {
    const double numerator = -n * (n - a);
    b += 2.0;
    d = numerator * d + b;
    c = b + numerator / c;
    d = 1.0 / (std::fabs(d) < kTiny ? kTiny : d);
    c = std::fabs(c) < kTiny ? kTiny : c;
    const double factor = c * d;
    value *= factor;
    if (std::fabs(factor - 1.0) < kPrecision) break;
  }
  return value * std::exp(a * std::log(x) - x - std::lgamma(a));
}

}  // namespace

double chi2_survival(double statistic, int dof) {
  if (!(statistic > 0.0) || dof <= 0) return 1.0;
  const double a = 0.5 * dof;
  const double x = 0.5 * statistic;
  return x < a + 1.0 ? 1.0 - lower_by_series(a, x) : upper_by_fraction(a, x);
}

Chi2Result chi2_test(std::span<const uint64_t> observed, std::span<const double> expected, double max_strays,
                     double min_expected) {
  Chi2Result result;
  int bins = 0;
  double total = 0;
  double strays = 0;
  double pooled_observed = 0;
  double pooled_expected = 0;
  const auto close = [&] {
    const double difference = pooled_observed - pooled_expected;
    result.statistic += difference * difference / pooled_expected;
    ++bins;
    pooled_observed = pooled_expected = 0;
  };
  for (size_t i = 0; i < observed.size(); ++i) {
    total += static_cast<double>(observed[i]);
    if (!(expected[i] > 1e-6)) strays += static_cast<double>(observed[i]);
    pooled_observed += static_cast<double>(observed[i]);
    pooled_expected += expected[i];
    if (pooled_expected >= min_expected) close();
  }
  if (pooled_expected > 1e-3) close();
  if (strays > max_strays * total) return {INFINITY, bins, 0.0};
  result.dof = bins - 1;
  result.p_value = chi2_survival(result.statistic, result.dof);
  return result;
}

double significance() { return 1.0 - std::pow(1.0 - kSuiteSignificance, 1.0 / kSuiteTests); }

}  // namespace relume::testing
