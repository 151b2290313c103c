#include "metrics/flip_filters.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace relume::detail {
namespace {

/// a · sqrt(π/b) · exp(-π² d²/b), d in degrees ([Andersson20 eq. 4]).
struct Gaussian {
  double a;
  double b;
};

// [Andersson20 table 1]; the second Gaussians of the first two channels have weight 0.
constexpr Gaussian kAchromatic{1.0, 0.0047};
constexpr Gaussian kRedGreen{1.0, 0.0053};
constexpr Gaussian kYellowFirst{34.1, 0.04};
constexpr Gaussian kYellowSecond{13.5, 0.025};

/// Width of the feature detectors in degrees, [Andersson20 §4.2].
constexpr double kFeatureWidth = 0.082;

constexpr double kPiSquared = 9.86960440108935862;

size_t index_of(int x, int y, int width) {
  return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
}

/// Scales the positive and the negative weights to sums of 1 and -1.
void balance(std::vector<double>& weights) {
  double positive = 0;
  double negative = 0;
  for (const double w : weights) (w > 0 ? positive : negative) += w;
  for (double& w : weights) w /= w > 0 ? positive : -negative;
}

/// Computes one output per pixel: `tap(sum, k, source)` over the 2 · radius + 1 sources along a row; borders are
/// replicated.
template <typename Out, typename In, typename Tap>
std::vector<Out> convolve_rows(const std::vector<In>& in, int width, int height, int radius, Tap&& tap) {
  std::vector<Out> out(in.size());
  for_each_row(height, [&](int y) {
    const In* row = &in[index_of(0, y, width)];
    std::vector<In> padded(static_cast<size_t>(width + 2 * radius));
    for (int x = -radius; x < width + radius; ++x)
      padded[static_cast<size_t>(int64_t{x} + radius)] = row[std::clamp(x, 0, width - 1)];
    const auto taps = 2 * static_cast<size_t>(radius) + 1;
    for (size_t x = 0; x < static_cast<size_t>(width); ++x) {
      Out sum(0);
      for (size_t k = 0; k < taps; ++k) tap(sum, k, padded[x + k]);
      out[index_of(0, y, width) + x] = sum;
    }
  });
  return out;
}

/// The same along columns; `finish` converts the sum to the output.
template <typename Sum, typename Out, typename In, typename Tap, typename Finish>
std::vector<Out> convolve_columns(const std::vector<In>& in, int width, int height, int radius, Tap&& tap,
                                  Finish&& finish) {
  std::vector<Out> out(in.size());
  for_each_row(height, [&](int y) {
    std::vector<Sum> sums(static_cast<size_t>(width), Sum(0));
    for (int k = -radius; k <= radius; ++k) {
      const In* row = &in[index_of(0, std::clamp(y + k, 0, height - 1), width)];
      for (int x = 0; x < width; ++x)
        tap(sums[static_cast<size_t>(x)], static_cast<size_t>(int64_t{k} + radius), row[x]);
    }
    for (int x = 0; x < width; ++x) out[index_of(x, y, width)] = finish(sums[static_cast<size_t>(x)]);
  });
  return out;
}

}  // namespace

void for_each_row(int height, const std::function<void(int)>& function) { parallel_for(height, function); }

ContrastKernel contrast_kernel(float pixels_per_degree) {
  const double ppd = pixels_per_degree;
  ContrastKernel kernel;
  // Three standard deviations of the widest Gaussian.
  kernel.radius = static_cast<int>(std::ceil(3.0 * std::sqrt(kYellowFirst.b / (2.0 * kPiSquared)) * ppd));
  const Gaussian gaussians[4] = {kAchromatic, kRedGreen, kYellowFirst, kYellowSecond};
  kernel.taps.assign(2 * static_cast<size_t>(kernel.radius) + 1, Vec4(0));
  double mass[4];  // sums of the two-dimensional kernels: squares of the one-dimensional sums
  for (int c = 0; c < 4; ++c) {
    const double a = gaussians[c].a;
    const double b = gaussians[c].b;
    const auto value = [&](int i) { return std::exp(-kPiSquared * (i / ppd) * (i / ppd) / b); };
    double sum = 0;
    for (int i = -kernel.radius; i <= kernel.radius; ++i) sum += value(i);
    for (int i = -kernel.radius; i <= kernel.radius; ++i)
      kernel.taps[static_cast<size_t>(int64_t{i} + kernel.radius)][c] = static_cast<float>(value(i) / sum);
    mass[c] = a * std::sqrt(static_cast<double>(kPi) / b) * sum * sum;
  }
  kernel.yellow_first = static_cast<float>(mass[2] / (mass[2] + mass[3]));
  kernel.yellow_second = static_cast<float>(mass[3] / (mass[2] + mass[3]));
  return kernel;
}

FeatureKernel feature_kernel(float pixels_per_degree) {
  const double deviation = 0.5 * kFeatureWidth * pixels_per_degree;
  FeatureKernel kernel;
  kernel.radius = static_cast<int>(std::ceil(3.0 * deviation));
  std::vector<double> gaussian;
  std::vector<double> first;
  std::vector<double> second;
  for (int i = -kernel.radius; i <= kernel.radius; ++i) {
    const double t = i / deviation;
    gaussian.push_back(std::exp(-0.5 * t * t));
    first.push_back(-t * gaussian.back());
    second.push_back((t * t - 1.0) * gaussian.back());
  }
  balance(gaussian);
  balance(first);
  balance(second);
  for (size_t i = 0; i < gaussian.size(); ++i)
    kernel.taps.emplace_back(static_cast<float>(gaussian[i]), static_cast<float>(first[i]),
                             static_cast<float>(second[i]));
  return kernel;
}

std::vector<Vec3> filter_contrast(const std::vector<Vec3>& opponent, int width, int height,
                                  const ContrastKernel& kernel) {
  const auto rows = convolve_rows<Vec4>(
      opponent, width, height, kernel.radius,
      [&](Vec4& sum, size_t k, const Vec3& c) { sum += kernel.taps[k] * Vec4(c.x, c.y, c.z, c.z); });
  return convolve_columns<Vec4, Vec3>(
      rows, width, height, kernel.radius, [&](Vec4& sum, size_t k, const Vec4& c) { sum += kernel.taps[k] * c; },
      [&](const Vec4& c) { return Vec3(c.x, c.y, kernel.yellow_first * c.z + kernel.yellow_second * c.w); });
}

std::vector<Vec2> detect_features(const std::vector<float>& luminance, int width, int height,
                                  const FeatureKernel& kernel) {
  const auto rows = convolve_rows<Vec3>(luminance, width, height, kernel.radius,
                                        [&](Vec3& sum, size_t k, float y) { sum += kernel.taps[k] * y; });
  // Components: d/dx, d/dy, d²/dx², d²/dy².
  return convolve_columns<Vec4, Vec2>(
      rows, width, height, kernel.radius,
      [&](Vec4& sum, size_t k, const Vec3& row) {
        const Vec3& tap = kernel.taps[k];
        sum += Vec4(tap.x * row.y, tap.y * row.x, tap.x * row.z, tap.z * row.x);
      },
      [](const Vec4& d) { return Vec2(std::sqrt(sqr(d.x) + sqr(d.y)), std::sqrt(sqr(d.z) + sqr(d.w))); });
}

}  // namespace relume::detail
