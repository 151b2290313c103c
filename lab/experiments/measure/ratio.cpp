#include "experiments/measure/ratio.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace relume {

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Quotient whose numerator is below the reference's noise: at most its upper bound over the denominator's lower bound.
Ratio ratio_of_unseen(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() < 2 || b.size() < 2) return {0, {0, kUnbounded, 0}};
  const double most = std::max(mean_interval(a).high, 0.0);
  const double least = mean_interval(b).low;
  return {0, {0, least > 0 ? most / least : kUnbounded, 0.95}};
}

}  // namespace

Ratio error_ratio(const std::vector<double>& a, const std::vector<double>& b) {
  const double mean_a = mean(a);
  const double mean_b = mean(b);
  // b's error is below the reference's own error, and thus unknown.
  if (!(mean_b > 0)) return {0, {0, kUnbounded, 0}};
  if (!(mean_a > 0)) return ratio_of_unseen(a, b);
  Ratio ratio{mean_a / mean_b, {mean_a / mean_b, mean_a / mean_b, 0}};
  if (a.size() < 2 || b.size() < 2) return ratio;
  const auto relative_variance = [](const std::vector<double>& values, double m) {
    const double s = standard_deviation(values);
    return s * s / (m * m * static_cast<double>(values.size()));
  };
  const double var_a = relative_variance(a, mean_a);
  const double var_b = relative_variance(b, mean_b);
  const double freedom_a = static_cast<double>(a.size() - 1);
  const double freedom_b = static_cast<double>(b.size() - 1);
  const double sum = var_a + var_b;
  const double freedom = sum > 0 ? sum * sum / (var_a * var_a / freedom_a + var_b * var_b / freedom_b) : freedom_a;
  const double spread = std::exp(student_t(std::max<size_t>(static_cast<size_t>(freedom), 1)) * std::sqrt(sum));
  ratio.interval = {ratio.value / spread, ratio.value * spread, 0.95};
  return ratio;
}

Ratio paired_error_ratio(const std::vector<double>& a, const std::vector<double>& b) {
  const double mean_a = mean(a);
  const double mean_b = mean(b);
  if (!(mean_a > 0 && mean_b > 0) || a.size() != b.size() || a.size() < 2) return error_ratio(a, b);
  std::vector<double> apart;  // deviations of the quotient's logarithm, to first order
  for (size_t i = 0; i < a.size(); ++i) apart.push_back(a[i] / mean_a - b[i] / mean_b);
  const double error = standard_deviation(apart) / std::sqrt(static_cast<double>(apart.size()));
  const double spread = std::exp(student_t(apart.size() - 1) * error);
  const double value = mean_a / mean_b;
  return {value, {value / spread, value * spread, 0.95}};
}

Ratio time_ratio(const std::vector<double>& a_s, const std::vector<double>& b_s) {
  std::vector<double> quotients;
  for (size_t i = 0; i < std::min(a_s.size(), b_s.size()); ++i) {
    if (b_s[i] > 0) quotients.push_back(a_s[i] / b_s[i]);
  }
  if (quotients.empty()) return {};
  return {median(quotients), median_interval(quotients)};
}

Ratio geometric_mean(const std::vector<double>& quotients) {
  std::vector<double> logs;
  for (const double q : quotients) logs.push_back(std::log(std::max(q, 1e-30)));
  const double value = std::exp(mean(logs));
  if (logs.size() < 2) return {value, {value, value, 0}};
  const double error = standard_deviation(logs) / std::sqrt(static_cast<double>(logs.size()));
  const double spread = std::exp(student_t(logs.size() - 1) * error);
  return {value, {value / spread, value * spread, 0.95}};
}

Ratio product(const Ratio& a, const Ratio& b) {
  const double value = a.value * b.value;
  if (!(value > 0)) return {0, {0, kUnbounded, 0}};
  const auto both = [](double x, double y) { return std::exp(std::hypot(std::log(x), std::log(y))); };
  return {value,
          {value / both(a.value / a.interval.low, b.value / b.interval.low),
           value * both(a.interval.high / a.value, b.interval.high / b.value),
           std::min(a.interval.confidence, b.interval.confidence)}};
}

Ratio quotient(const Ratio& a, const Ratio& b) {
  if (!(b.interval.low > 0)) return {0, {0, kUnbounded, 0}};
  return product(a, {1 / b.value, {1 / b.interval.high, 1 / b.interval.low, b.interval.confidence}});
}

std::string share_text(const Ratio& ratio) {
  if (!std::isfinite(ratio.interval.high))
    return fmt::format("{:.2f} (at least {:.2f})", ratio.value, ratio.interval.low);
  if (ratio.interval.confidence == 0) return fmt::format("{:.2f}", ratio.value);
  return fmt::format("{:.2f} ({:.2f} to {:.2f})", ratio.value, ratio.interval.low, ratio.interval.high);
}

std::string to_text(const Ratio& ratio) {
  if (!std::isfinite(ratio.interval.high))
    return fmt::format("{:.3g}× (at least {:.3g})", ratio.value, ratio.interval.low);
  return fmt::format("{:.3g}× ({:.3g} to {:.3g})", ratio.value, ratio.interval.low, ratio.interval.high);
}

Claim judged_ratios(std::string id, std::string paper, std::string claim, std::string measured,
                    const std::vector<Ratio>& ratios, double least) {
  std::vector<const char*> verdicts;
  for (const Ratio& ratio : ratios) verdicts.push_back(verdict_of(ratio.interval, least));
  return with_verdict(std::move(id), std::move(paper), std::move(claim), std::move(measured),
                      fmt::format("{}at least {:.2g}×, by the interval", ratios.size() > 1 ? "each " : "", least),
                      verdict_of_all(verdicts));
}

Claim judged_within(std::string id, std::string paper, std::string claim, std::string measured, std::string threshold,
                    const std::vector<Ratio>& ratios, double least, double most) {
  std::vector<const char*> verdicts;
  for (const Ratio& ratio : ratios) verdicts.push_back(verdict_of(ratio.interval, least, most));
  return with_verdict(std::move(id), std::move(paper), std::move(claim), std::move(measured),
                      threshold + ", by the interval", verdict_of_all(verdicts));
}

}  // namespace relume
