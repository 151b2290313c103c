// Pearson's χ² test of samples against their density, for tests only.
#pragma once

#include <cstdint>
#include <span>

namespace relume::testing {

/// Probability that a χ² variable with `dof` degrees of freedom exceeds `statistic`. Computes the regularised upper
/// incomplete gamma function Q(dof/2, statistic/2) by its series or continued fraction, to about ten digits.
double chi2_survival(double statistic, int dof);

struct Chi2Result {
  double statistic = 0;
  int dof = 0;
  double p_value = 1;
};

/// Compares counts with expected counts per bin. Bins that expect fewer than `min_expected` are pooled in order,
/// because χ² is the limit of many samples per bin. p = 0 if more than the fraction `max_strays` of the samples lies
/// where none is expected.
Chi2Result chi2_test(std::span<const uint64_t> observed, std::span<const double> expected, double max_strays = 0,
                     double min_expected = 10);

/// Upper bound on the number of hypothesis tests in the whole suite.
inline constexpr int kSuiteTests = 10000;
/// Probability that the whole suite raises a false alarm. Seeds are fixed: a suite that passes once keeps passing. The
/// bound makes a failure after a code change significant.
inline constexpr double kSuiteSignificance = 1e-3;

/// p-value below which one test of the suite rejects: Šidák's correction 1 − (1 − α)^(1/n) for n independent tests.
double significance();

}  // namespace relume::testing
