#include "sampling/distribution_2d.h"

#include <cmath>

namespace relume {
namespace {

/// Writes the CDF of `count` values from `sums` (partial sums in double); uniform if all values are zero.
void write_cdf(const std::vector<double>& sums, float* cdf) {
  const size_t count = sums.size() - 1;
  const double total = sums.back();
  for (size_t i = 0; i <= count; ++i) {
    cdf[i] = static_cast<float>(total > 0 ? sums[i] / total : static_cast<double>(i) / static_cast<double>(count));
  }
}

}  // namespace

Distribution2DStorage build_distribution_2d(std::span<const float> values, uint32_t width, uint32_t height) {
  Distribution2DStorage result;
  std::vector<double> row_sums(height + 1, 0.0);
  std::vector<double> sums(width + 1, 0.0);
  result.conditional.resize(static_cast<size_t>(height) * (width + 1));
  for (uint32_t j = 0; j < height; ++j) {
    for (uint32_t i = 0; i < width; ++i) sums[i + 1] = sums[i] + values[static_cast<size_t>(j) * width + i];
    write_cdf(sums, result.conditional.data() + static_cast<size_t>(j) * (width + 1));
    row_sums[j + 1] = row_sums[j] + sums[width];
  }
  if (!(row_sums.back() > 0) || !std::isfinite(row_sums.back())) return {};
  result.marginal.resize(height + 1);
  write_cdf(row_sums, result.marginal.data());
  result.width = width;
  result.height = height;
  return result;
}

}  // namespace relume
