#include "relume/lab/metrics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/parallel.h"
#include "core/srgb.h"
#include "relume/error.h"

namespace relume {
namespace {

/// Sums over one row or all rows. Rows are added in order, so the result does not depend on threads.
struct Sums {
  double squared = 0;
  double relative_squared = 0;
  double absolute = 0;
  double relative_absolute = 0;
  std::array<double, 3> a{};
  std::array<double, 3> b{};
  uint64_t pixels = 0;
  uint64_t nonfinite_a = 0;
  uint64_t nonfinite_b = 0;

  void add_pixel(const Rgb& x, const Rgb& y) {
    const bool finite_a = is_finite(x);
    const bool finite_b = is_finite(y);
    if (!finite_a) ++nonfinite_a;
    if (!finite_b) ++nonfinite_b;
    if (!finite_a || !finite_b) return;
    ++pixels;
    for (int c = 0; c < 3; ++c) {
      const double value = x[c];
      const double reference = y[c];
      const double d = value - reference;
      squared += d * d;
      relative_squared += d * d / (reference * reference + kRelativeEpsilon);
      absolute += std::fabs(d);
      relative_absolute += std::fabs(d) / (std::fabs(reference) + kRelativeEpsilon);
      a[static_cast<size_t>(c)] += value;
      b[static_cast<size_t>(c)] += reference;
    }
  }

  void add(const Sums& other) {
    squared += other.squared;
    relative_squared += other.relative_squared;
    absolute += other.absolute;
    relative_absolute += other.relative_absolute;
    for (size_t c = 0; c < 3; ++c) {
      a[c] += other.a[c];
      b[c] += other.b[c];
    }
    pixels += other.pixels;
    nonfinite_a += other.nonfinite_a;
    nonfinite_b += other.nonfinite_b;
  }
};

Sums sum_of_rows(const std::vector<Sums>& rows) {
  Sums total;
  for (const Sums& row : rows) total.add(row);
  return total;
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

[[noreturn]] void fail_nothing_finite() {
  throw Error("the images have no pixel that is finite in both; check their source");
}

}  // namespace

void check_same_size(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height)
    throw Error(fmt::format("the images have different sizes, {}x{} and {}x{}; render both at the same size", a.width,
                            a.height, b.width, b.height));
  if (a.width <= 0 || a.height <= 0) throw Error("the images have no pixels; render them at a size above 0");
}

double without_noise(double mse, double reference_mse) { return std::max(mse - reference_mse, 0.1 * mse); }

Metrics compute_metrics(const Image& a, const Image& b, const MetricOptions& options) {
  check_same_size(a, b);
  std::vector<Sums> rows(static_cast<size_t>(a.height));
  parallel_for(a.height, [&](int y) {
    for (int x = 0; x < a.width; ++x) rows[static_cast<size_t>(y)].add_pixel(a.at(x, y), b.at(x, y));
  });
  const Sums sums = sum_of_rows(rows);
  if (sums.pixels == 0) fail_nothing_finite();
  const double pixels = static_cast<double>(sums.pixels);
  Metrics m;
  m.mse = sums.squared / (3.0 * pixels);
  m.rel_mse = sums.relative_squared / (3.0 * pixels);
  m.mae = sums.absolute / (3.0 * pixels);
  m.mape = sums.relative_absolute / (3.0 * pixels);
  for (size_t c = 0; c < 3; ++c) {
    m.mean_a[c] = sums.a[c] / pixels;
    m.mean_b[c] = sums.b[c] / pixels;
  }
  m.pixels = sums.pixels;
  m.nonfinite_a = sums.nonfinite_a;
  m.nonfinite_b = sums.nonfinite_b;
  if (options.flip) {
    m.flip = mean(flip_map(tone_map(a, options.tone_map, options.exposure),
                           tone_map(b, options.tone_map, options.exposure), options.pixels_per_degree));
  }
  if (options.hdr_flip) m.hdr_flip = mean(hdr_flip_map(a, b, flip_exposures(b), options.pixels_per_degree));
  return m;
}

Image color_map(std::span<const float> values, int width, int height) {
  // Ten equidistant samples of magma (van der Walt and Smith 2015, CC0), as sRGB.
  constexpr std::array<uint32_t, 10> kMagma{0x000004, 0x180f3d, 0x440f76, 0x721f81, 0x9e2f7f,
                                            0xcd4071, 0xf1605d, 0xfd9668, 0xfeca8d, 0xfcfdbf};
  const auto stop = [&](size_t i) {
    const uint32_t c = kMagma[i];
    return Rgb(static_cast<float>(c >> 16), static_cast<float>(c >> 8 & 255u), static_cast<float>(c & 255u)) / 255.0f;
  };
  Image image(width, height);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const float x = values[i] * 9.0f;
    if (std::isnan(x)) {
      image.pixels[i] = Rgb(0, 1, 0);
      continue;
    }
    const auto low = static_cast<size_t>(clamp(std::floor(x), 0.0f, 8.0f));
    const float t = clamp(x - static_cast<float>(low), 0.0f, 1.0f);
    image.pixels[i] = linear_from_srgb((1.0f - t) * stop(low) + t * stop(low + 1));
  }
  return image;
}

std::vector<float> relative_error_map(const Image& a, const Image& b) {
  check_same_size(a, b);
  constexpr float kEpsilon = static_cast<float>(kRelativeEpsilon);
  std::vector<float> map(a.pixels.size());
  for (size_t i = 0; i < map.size(); ++i) {
    const Rgb d = a.pixels[i] - b.pixels[i];
    const Rgb relative = d * d / (b.pixels[i] * b.pixels[i] + kEpsilon);
    map[i] = (relative.r + relative.g + relative.b) / 3.0f;
  }
  return map;
}

}  // namespace relume
