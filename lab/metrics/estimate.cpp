#include "metrics/estimate.h"

#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <glm/vec3.hpp>

#include "metrics/statistics.h"
#include "relume/error.h"
#include "relume/lab/metrics.h"

namespace relume {
namespace {

double sum_of(const glm::dvec3& v) { return v.x + v.y + v.z; }

}  // namespace

double Estimate::error() const {
  const auto n = static_cast<double>(without.size());
  if (without.size() < 2) return 0;
  const double mean = std::accumulate(without.begin(), without.end(), 0.0) / n;
  double squares = 0;
  for (const double w : without) squares += (w - mean) * (w - mean);
  return std::sqrt(squares * (n - 1) / n);
}

double Estimate::half_width() const { return without.size() < 2 ? 0 : student_t(without.size() - 1) * error(); }

Estimate mean_estimate(const std::vector<double>& values) {
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  const auto n = static_cast<double>(values.size());
  Estimate result{sum / n, {}};
  for (const double v : values) result.without.push_back(values.size() > 1 ? (sum - v) / (n - 1) : v);
  return result;
}

Estimate scaled(Estimate estimate, double factor) {
  estimate.value *= factor;
  for (double& value : estimate.without) value *= factor;
  return estimate;
}

Estimate difference(const Estimate& a, const Estimate& b) {
  if (a.without.size() != b.without.size())
    throw Error(fmt::format("estimates of {} and {} repetitions cannot be compared; give both the same number",
                            a.without.size(), b.without.size()));
  Estimate result{a.value - b.value, a.without};
  for (size_t i = 0; i < b.without.size(); ++i) result.without[i] -= b.without[i];
  return result;
}

Estimate squared_bias(const std::vector<Image>& repetitions, const Image& reference, double reference_mse) {
  const size_t n = repetitions.size();
  if (n < 3)
    throw Error(fmt::format(
        "the error of a squared bias needs at least three repetitions, not {}; raise the number of repetitions", n));
  for (const Image& image : repetitions) check_same_size(image, reference);
  // Σ_{r≠s} d_r d_s = (Σ d_r)² − Σ d_r²; without repetition k, the same sums over the others.
  double all = 0;
  std::vector<double> without(n, 0.0);
  size_t pixels = 0;
  for (size_t i = 0; i < reference.pixels.size(); ++i) {
    glm::dvec3 sum(0);
    glm::dvec3 squares(0);
    for (const Image& image : repetitions) {
      const glm::dvec3 d = glm::dvec3(image.pixels[i]) - glm::dvec3(reference.pixels[i]);
      sum += d;
      squares += d * d;
    }
    if (!std::isfinite(sum_of(squares))) continue;
    ++pixels;
    all += sum_of(sum * sum - squares);
    for (size_t k = 0; k < n; ++k) {
      const glm::dvec3 d = glm::dvec3(repetitions[k].pixels[i]) - glm::dvec3(reference.pixels[i]);
      const glm::dvec3 rest = sum - d;
      without[k] += sum_of(rest * rest - (squares - d * d));
    }
  }
  if (pixels == 0) throw Error("no pixel is finite in all images; check their source");
  const auto count = static_cast<double>(n);
  const double values = 3.0 * static_cast<double>(pixels);
  Estimate result{all / (values * count * (count - 1)) - reference_mse, {}};
  for (const double w : without) result.without.push_back(w / (values * (count - 1) * (count - 2)) - reference_mse);
  return result;
}

}  // namespace relume
