#include "metrics/ensemble.h"

#include "core/vec.h"
#include "metrics/estimate.h"
#include "relume/error.h"
#include "relume/lab/metrics.h"

namespace relume {
namespace {

/// Number of groups of repetitions, each omitted in turn to estimate the error of bias².
constexpr size_t kMostGroups = 8;
constexpr size_t kFewestGroups = 3;

}  // namespace

void Ensemble::add(const Image& image) {
  if (count_ == 0) {
    mean_ = Image(image.width, image.height);
    m2_.assign(mean_.pixels.size(), Rgb(0));
  }
  check_same_size(mean_, image);
  add_to_group(image);
  ++count_;
  for (size_t i = 0; i < m2_.size(); ++i) {
    const Rgb before = mean_.pixels[i];
    mean_.pixels[i] += (image.pixels[i] - before) / static_cast<float>(count_);
    m2_[i] += (image.pixels[i] - before) * (image.pixels[i] - mean_.pixels[i]);
  }
}

void Ensemble::add_to_group(const Image& image) {
  const auto turn = static_cast<size_t>(count_);
  const size_t index = turn % kMostGroups;
  if (index == groups_.size()) {
    groups_.push_back(image);
    return;
  }
  Image& group = groups_[index];
  const auto members = static_cast<float>(turn / kMostGroups + 1);
  for (size_t i = 0; i < group.pixels.size(); ++i) group.pixels[i] += (image.pixels[i] - group.pixels[i]) / members;
}

ErrorSplit Ensemble::split(const Image& reference, double reference_mse) const {
  if (count_ < 2) throw Error("bias and variance need at least two repetitions; repeat with another seed");
  check_same_size(mean_, reference);
  const double n = count_;
  ErrorSplit result;
  for (size_t i = 0; i < m2_.size(); ++i) {
    const Rgb difference = mean_.pixels[i] - reference.pixels[i];
    if (!is_finite(difference) || !is_finite(m2_[i])) continue;
    ++result.pixels;
    for (int c = 0; c < 3; ++c) {
      const double variance = m2_[i][c] / (n - 1);
      result.variance += variance;
      result.bias2 += double(difference[c]) * difference[c] - variance / n;
    }
  }
  if (result.pixels == 0) throw Error("no pixel is finite in all images; check their source");
  const double values = 3.0 * static_cast<double>(result.pixels);
  result.bias2 = result.bias2 / values - reference_mse;
  result.variance /= values;
  if (groups_.size() >= kFewestGroups) result.bias2_error = squared_bias(groups_, reference, reference_mse).error();
  return result;
}

}  // namespace relume
