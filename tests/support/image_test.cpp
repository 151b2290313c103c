#include "support/image_test.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "relume/lab/metrics.h"

namespace relume::support {
namespace {

/// Continued fraction of the incomplete beta function by Lentz's method (NIST DLMF 8.17.22).
double beta_fraction(double a, double b, double x) {
  constexpr double tiny = 1e-300;
  const auto away_from_zero = [](double v) { return std::fabs(v) < tiny ? tiny : v; };
  double c = 1;
  double d = 1 / away_from_zero(1 - (a + b) * x / (a + 1));
  double value = d;
  for (int m = 1; m <= 500; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    double factor = 1;
    for (const double term : {even, odd}) {
      d = 1 / away_from_zero(1 + term * d);
      c = away_from_zero(1 + term / c);
      factor = c * d;
      value *= factor;
    }
    if (std::fabs(factor - 1) < 1e-14) break;
  }
  return value;
}

/// Regularised incomplete beta function I_x(a, b).
double incomplete_beta(double a, double b, double x) {
  if (x <= 0 || x >= 1) return x <= 0 ? 0 : 1;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
  return 1 - front * beta_fraction(b, a, 1 - x) / b;
}

/// Mean and variance of a quantity over the images of a side.
struct Sample {
  double mean = 0;
  double variance = 0;  ///< of one image
  int count = 0;
};

/// Two-sided p-value for equal means. Differences within single-precision rounding are ignored.
double welch_p(const Sample& a, const Sample& b) {
  constexpr double kRounding = 1e-5;
  const double difference = std::fabs(a.mean - b.mean);
  if (difference <= kRounding * (std::fabs(a.mean) + std::fabs(b.mean))) return 1;
  const double va = a.variance / a.count;
  const double vb = b.variance / b.count;
  if (va + vb <= 0) return 0;
  const double degrees = (va + vb) * (va + vb) / (va * va / (a.count - 1) + vb * vb / (b.count - 1));
  return student_two_sided_p(difference / std::sqrt(va + vb), degrees);
}

double sidak(double significance, double tests) { return -std::expm1(std::log1p(-significance) / tests); }

/// Statistics over images of a channel's mean in a part of the image.
Sample part_sample(const Moments& m, int x0, int y0, int x1, int y1, int channel) {
  Sample sample{.count = m.count};
  std::vector<double> means;
  for (const Image& image : m.images) {
    double sum = 0;
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) sum += static_cast<double>(image.at(x, y)[channel]);
    }
    means.push_back(sum / ((x1 - x0) * (y1 - y0)));
    sample.mean += means.back() / m.count;
  }
  for (const double v : means) sample.variance += (v - sample.mean) * (v - sample.mean) / (m.count - 1);
  return sample;
}

/// Tests of a channel's means in parts of the image, all of one size except at the border.
struct PartTest {
  double worst = 0;       ///< relative difference
  double detectable = 0;  ///< relative error at which a part is rejected, weighted by the parts' radiance
  int rejected = 0;
};

PartTest compare_parts(const Moments& a, const Moments& b, int part_width, int part_height,
                       const ImageTestOptions& options) {
  const int columns = (a.width + part_width - 1) / part_width;
  const int rows = (a.height + part_height - 1) / part_height;
  const double threshold = sidak(options.significance, 3.0 * columns * rows);
  const double quantile = student_two_sided_quantile(threshold, a.count + b.count - 2);
  PartTest test;
  double light = 0;
  double errors = 0;
  for (int i = 0; i < columns * rows * 3; ++i) {
    const int x0 = i / 3 % columns * part_width;
    const int y0 = i / 3 / columns * part_height;
    const int x1 = std::min(x0 + part_width, a.width);
    const int y1 = std::min(y0 + part_height, a.height);
    const Sample sa = part_sample(a, x0, y0, x1, y1, i % 3);
    const Sample sb = part_sample(b, x0, y0, x1, y1, i % 3);
    if (!(sb.mean > 0)) {
      test.rejected += sa.mean > 0 ? 1 : 0;
      continue;
    }
    light += sb.mean;
    errors += std::sqrt(sa.variance / sa.count + sb.variance / sb.count);
    const double difference = std::fabs(sa.mean - sb.mean) / sb.mean;
    test.worst = std::max(test.worst, difference);
    if (difference > options.tolerance && welch_p(sa, sb) < threshold) ++test.rejected;
  }
  test.detectable = light > 0 ? std::max(quantile * errors / light, options.tolerance) : INFINITY;
  return test;
}

}  // namespace

double student_two_sided_p(double t, double degrees) {
  return incomplete_beta(0.5 * degrees, 0.5, degrees / (degrees + t * t));
}

double student_two_sided_quantile(double p, double degrees) {
  double low = 0;
  double high = 1;
  while (student_two_sided_p(high, degrees) > p) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (student_two_sided_p(middle, degrees) > p ? low : high) = middle;
  }
  return high;
}

std::string ImageTest::report() const {
  return fmt::format(
      "pixels: {} of {} rejected, least p {:.2g} against {:.2g}; blocks: {} rejected, largest difference {:.2f} %, "
      "detectable {:.2f} %; image: {} rejected, {:.2f} %, detectable {:.2f} %",
      rejected_pixels, p.size(), least_p, pixel_threshold, rejected_blocks, 100 * worst_block, 100 * detectable,
      rejected_means, 100 * worst_mean, 100 * detectable_mean);
}

ImageTest compare(const Moments& a, const Moments& b, const ImageTestOptions& options) {
  EXPECT_GE(std::min(a.count, b.count), 16);
  EXPECT_TRUE(a.width == b.width && a.height == b.height);
  ImageTest test;
  test.pixel_threshold = sidak(options.significance, 3.0 * static_cast<double>(a.mean.size()));
  for (size_t i = 0; i < a.mean.size(); ++i) {
    double p = 1;
    for (int c = 0; c < 3; ++c) {
      p = std::min(p, welch_p({a.mean[i][c], a.variance[i][c], a.count}, {b.mean[i][c], b.variance[i][c], b.count}));
    }
    test.p.push_back(static_cast<float>(p));
    test.least_p = std::min(test.least_p, p);
    test.rejected_pixels += options.pixels && p < test.pixel_threshold ? 1 : 0;
  }
  const PartTest blocks = compare_parts(a, b, options.block_size, options.block_size, options);
  test.worst_block = blocks.worst;
  test.rejected_blocks = blocks.rejected;
  test.detectable = blocks.detectable;
  const PartTest image = compare_parts(a, b, a.width, a.height, options);
  test.worst_mean = image.worst;
  test.rejected_means = image.rejected;
  test.detectable_mean = image.detectable;
  return test;
}

void expect_same_image(const std::string& name, const Moments& a, const Moments& b, const ImageTestOptions& options) {
  const ImageTest test = compare(a, b, options);
  ::testing::Test::RecordProperty("agreement", test.report());
  EXPECT_LT(options.detectable, kMostDetectable) << name << ": a black block would hardly show";
  EXPECT_LE(test.detectable, options.detectable) << name << ": blocks are too noisy to tell";
  EXPECT_LE(test.detectable_mean, options.detectable_mean) << name << ": the image is too noisy to tell";
  if (test.agree()) return;
  const std::filesystem::path folder = RELUME_TEST_RESULTS;
  std::filesystem::create_directories(folder);
  write_image(folder / (name + "-a.exr"), a.mean_image());
  write_image(folder / (name + "-b.exr"), b.mean_image());
  std::vector<float> brightness;
  for (const float p : test.p) {
    brightness.push_back(static_cast<float>(std::log(std::max(double{p}, 1e-300)) / std::log(test.pixel_threshold)));
  }
  write_image(folder / (name + "-p.png"), color_map(brightness, a.width, a.height));
  ADD_FAILURE() << name << ": the images differ; " << test.report() << "; see " << (folder / name).string()
                << "-{a.exr,b.exr,p.png}";
}

}  // namespace relume::support
