#include "relume/lab/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "core/hash.h"
#include "metrics/flip_filters.h"
#include "relume/error.h"

namespace relume {
namespace {

using Triple = std::array<double, 3>;

Image constant(int width, int height, const Rgb& color) {
  Image image(width, height);
  std::fill(image.pixels.begin(), image.pixels.end(), color);
  return image;
}

/// Smooth shapes with an edge and some dots.
Image make_image(int width, int height, uint32_t seed) {
  Image image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float wave = 0.5f + 0.4f * std::sin(0.37f * static_cast<float>(x) + 0.1f * static_cast<float>(seed));
      const float edge = x + y > width ? 0.8f : 0.1f;
      const float dot = to_unit_float(hash(seed, static_cast<uint32_t>(y * width + x))) > 0.95f ? 0.9f : 0.2f;
      image.at(x, y) = {wave, edge, dot};
    }
  }
  return image;
}

/// FLIP at one pixel, directly from the paper's equations: double precision, two-dimensional kernels, no shared code.
class DirectFlip {
 public:
  DirectFlip(const Image& test, const Image& reference, double ppd) : test_(test), reference_(reference), ppd_(ppd) {}

  double at(int x, int y) const {
    const double color = redistributed(color_difference(filtered_lab(test_, x, y), filtered_lab(reference_, x, y)));
    const auto [edge_a, point_a] = features(test_, x, y);
    const auto [edge_b, point_b] = features(reference_, x, y);
    const double feature =
        std::sqrt(std::max(std::fabs(edge_a - edge_b), std::fabs(point_a - point_b)) / std::sqrt(2.0));
    return std::pow(color, 1.0 - feature);
  }

  static double redistributed(double d) {
    const double most = color_difference(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1}));
    return d < 0.4 * most ? 0.95 / (0.4 * most) * d : 0.95 + (d - 0.4 * most) / (0.6 * most) * 0.05;
  }

  static double color_difference(const Triple& a, const Triple& b) {
    return std::pow(std::fabs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]), 0.7);
  }

  static Triple hunt_lab(const Triple& rgb) {
    const Triple xyz = xyz_over_white(rgb);
    const auto f = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; };
    const double lightness = 116.0 * f(xyz[1]) - 16.0;
    return {lightness, 0.01 * lightness * 500.0 * (f(xyz[0]) - f(xyz[1])),
            0.01 * lightness * 200.0 * (f(xyz[1]) - f(xyz[2]))};
  }

 private:
  static constexpr double kM[3][3] = {{0.4123865632529917, 0.35759149092062537, 0.18045049120356368},
                                      {0.21263682167732384, 0.7151829818412507, 0.07218019648142547},
                                      {0.019330620152483987, 0.11919716364020845, 0.9503725870054354}};

  static Triple xyz_over_white(const Triple& rgb) {
    Triple xyz{};
    for (size_t i = 0; i < 3; ++i) {
      for (size_t j = 0; j < 3; ++j) xyz[i] += kM[i][j] * rgb[j];
      xyz[i] /= kM[i][0] + kM[i][1] + kM[i][2];
    }
    return xyz;
  }

  static Triple opponent(const Rgb& c) {
    const Triple t = xyz_over_white({c.r, c.g, c.b});
    return {116.0 * t[1] - 16.0, 500.0 * (t[0] - t[1]), 200.0 * (t[1] - t[2])};
  }

  static Triple rgb_of_opponent(const Triple& c) {
    const double y = (c[0] + 16.0) / 116.0;
    const Triple v{(y + c[1] / 500.0) * (kM[0][0] + kM[0][1] + kM[0][2]), y,
                   (y - c[2] / 200.0) * (kM[2][0] + kM[2][1] + kM[2][2])};
    // Cramer's rule.
    const auto det = [](const double(&m)[3][3]) {
      return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    };
    Triple rgb{};
    for (size_t j = 0; j < 3; ++j) {
      double m[3][3];
      for (size_t i = 0; i < 3; ++i) {
        for (size_t k = 0; k < 3; ++k) m[i][k] = k == j ? v[i] : kM[i][k];
      }
      rgb[j] = std::clamp(det(m) / det(kM), 0.0, 1.0);
    }
    return rgb;
  }

  static const Rgb& clamped(const Image& image, int x, int y) {
    return image.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1));
  }

  Triple filtered_lab(const Image& image, int x, int y) const {
    const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * M_PI * M_PI)) * ppd_));
    const double a[3][2] = {{1.0, 0.0}, {1.0, 0.0}, {34.1, 13.5}};
    const double b[3][2] = {{0.0047, 1e-5}, {0.0053, 1e-5}, {0.04, 0.025}};
    Triple sum{};
    Triple weight{};
    for (int j = -radius; j <= radius; ++j) {
      for (int i = -radius; i <= radius; ++i) {
        const Triple c = opponent(clamped(image, x + i, y + j));
        const double d2 = (i * i + j * j) / (ppd_ * ppd_);
        for (size_t k = 0; k < 3; ++k) {
          double g = 0;
          for (size_t l = 0; l < 2; ++l)
            g += a[k][l] * std::sqrt(M_PI / b[k][l]) * std::exp(-M_PI * M_PI * d2 / b[k][l]);
          sum[k] += g * c[k];
          weight[k] += g;
        }
      }
    }
    for (size_t k = 0; k < 3; ++k) sum[k] /= weight[k];
    return hunt_lab(rgb_of_opponent(sum));
  }

  /// Response of a detector with positive weights that sum to 1 and negative ones that sum to -1.
  double response(const Image& image, int x, int y, int radius, const std::function<double(int, int)>& weight) const {
    double sums[2] = {0, 0};
    double weights[2] = {0, 0};
    for (int j = -radius; j <= radius; ++j) {
      for (int i = -radius; i <= radius; ++i) {
        const double w = weight(i, j);
        const double value = (opponent(clamped(image, x + i, y + j))[0] + 16.0) / 116.0;
        const size_t sign = w > 0 ? 1 : 0;
        sums[sign] += w * value;
        weights[sign] += std::fabs(w);
      }
    }
    return sums[0] / weights[0] + sums[1] / weights[1];
  }

  std::pair<double, double> features(const Image& image, int x, int y) const {
    const double s = 0.5 * 0.082 * ppd_;
    const int radius = static_cast<int>(std::ceil(3.0 * s));
    const auto g = [s](int i, int j) { return std::exp(-(i * i + j * j) / (2.0 * s * s)); };
    const double dx = response(image, x, y, radius, [&](int i, int j) { return -i * g(i, j); });
    const double dy = response(image, x, y, radius, [&](int i, int j) { return -j * g(i, j); });
    const double dxx = response(image, x, y, radius, [&](int i, int j) { return (i * i / (s * s) - 1.0) * g(i, j); });
    const double dyy = response(image, x, y, radius, [&](int i, int j) { return (j * j / (s * s) - 1.0) * g(i, j); });
    return {std::hypot(dx, dy), std::hypot(dxx, dyy)};
  }

  const Image& test_;
  const Image& reference_;
  double ppd_;
};

TEST(Flip, MatchesADirectEvaluationOfThePaper) {
  const Image test = make_image(48, 40, 1);
  const Image reference = make_image(48, 40, 2);
  for (const float ppd : {30.0f, kDefaultPixelsPerDegree}) {
    const std::vector<float> map = flip_map(test, reference, ppd);
    const DirectFlip direct(test, reference, static_cast<double>(ppd));
    for (const auto& [x, y] :
         {std::pair{0, 0}, std::pair{47, 39}, std::pair{20, 20}, std::pair{31, 5}, std::pair{9, 38}, std::pair{28, 21}})
      EXPECT_NEAR(map[static_cast<size_t>(y * 48 + x)], direct.at(x, y), 2e-4)
          << x << ' ' << y << ' ' << ppd;  // float precision
  }
}

TEST(Flip, UniformPairsReduceToTheColourDifference) {
  // Filters preserve uniform images, which have no features, so the value is the redistributed HyAB distance.
  const std::pair<Triple, Triple> pairs[] = {{{0.2, 0.4, 0.6}, {0.25, 0.4, 0.5}},
                                             {{1, 1, 1}, {0, 0, 0}},
                                             {{1, 0, 0}, {0, 1, 0}},
                                             {{0.5, 0.5, 0.5}, {0.51, 0.5, 0.5}}};
  for (const auto& [a, b] : pairs) {
    const auto rgb = [](const Triple& t) {
      return Rgb(static_cast<float>(t[0]), static_cast<float>(t[1]), static_cast<float>(t[2]));
    };
    const double expected =
        DirectFlip::redistributed(DirectFlip::color_difference(DirectFlip::hunt_lab(a), DirectFlip::hunt_lab(b)));
    const std::vector<float> map = flip_map(constant(24, 24, rgb(a)), constant(24, 24, rgb(b)));
    for (const float value : map) ASSERT_NEAR(value, expected, 1e-3);  // cancellation in the float features
  }
}

TEST(Flip, IdenticalIsZeroAndOppositeIsNearOne) {
  const Image image = make_image(32, 32, 1);
  for (const float value : flip_map(image, image)) ASSERT_EQ(value, 0.0f);
  for (const float value : flip_map(constant(16, 16, Rgb(0)), constant(16, 16, Rgb(1)))) EXPECT_GT(value, 0.95f);
  const std::vector<float> most = flip_map(constant(16, 16, Rgb(0, 1, 0)), constant(16, 16, Rgb(0, 0, 1)));
  for (const float value : most) EXPECT_NEAR(value, 1.0f, 1e-3f);  // the pair that defines the maximum
}

TEST(Flip, IsSymmetric) {
  const Image a = make_image(32, 32, 1);
  const Image b = make_image(32, 32, 5);
  EXPECT_EQ(flip_map(a, b), flip_map(b, a));
}

TEST(Flip, HighFrequenciesAreHarderToSeeFromAfar) {
  // One-pixel noise against grey of the same mean.
  Image noise(64, 64);
  for (size_t i = 0; i < noise.pixels.size(); ++i)
    noise.pixels[i] = Rgb((hash(static_cast<uint32_t>(i)) & 1u) ? 0.45f : 0.55f);
  const Image grey = constant(64, 64, Rgb(0.5f));
  const auto mean = [](const std::vector<float>& map) {
    double sum = 0;
    for (const float x : map) sum += x;
    return sum / static_cast<double>(map.size());
  };
  EXPECT_LT(mean(flip_map(noise, grey, 120.0f)), 0.7 * mean(flip_map(noise, grey, 20.0f)));
}

TEST(Flip, KernelsAreNormalised) {
  for (const float ppd : {5.0f, kDefaultPixelsPerDegree, 150.0f}) {
    const detail::ContrastKernel contrast = detail::contrast_kernel(ppd);
    Vec4 sum(0);
    for (const Vec4& tap : contrast.taps) sum += tap;
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(sum[c], 1.0f, 1e-5f);
    EXPECT_NEAR(contrast.yellow_first + contrast.yellow_second, 1.0f, 1e-6f);
    const detail::FeatureKernel feature = detail::feature_kernel(ppd);
    Vec3 features(0);
    for (const Vec3& tap : feature.taps) features += tap;
    EXPECT_NEAR(features.x, 1.0f, 1e-5f);
    EXPECT_NEAR(features.y, 0.0f, 1e-5f);
    EXPECT_NEAR(features.z, 0.0f, 1e-5f);
  }
}

TEST(Flip, DifferentSizesAreAnError) { EXPECT_THROW(flip_map(Image(2, 2), Image(2, 3)), Error); }

TEST(HdrFlip, ExposuresFollowTheReference) {
  Image image = constant(10, 10, Rgb(0.5f));
  image.at(3, 3) = Rgb(64.0f);
  const FlipExposures e = flip_exposures(image);
  EXPECT_NEAR(e.stop - e.start, 7.0f, 1e-4f);  // log2(64 / 0.5)
  EXPECT_EQ(e.count, 7);
  // At the stop exposure, the median maps to 0.85 (Narkowicz's fit with factor 0.6).
  const double x = 0.6 * 0.5 * std::exp2(static_cast<double>(e.stop));
  EXPECT_NEAR(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.85, 1e-4);
  EXPECT_EQ(flip_exposures(constant(4, 4, Rgb(1))).count, 2);
  EXPECT_EQ(flip_exposures(Image(4, 4)).count, 2);
}

TEST(HdrFlip, DarkMediansAreBounded) {
  Image image(11, 11);
  image.at(1, 1) = Rgb(1.0f);
  EXPECT_LE(flip_exposures(image).count, 30);
}

TEST(HdrFlip, SeesDifferencesAboveTheDisplayRange) {
  const Image reference = constant(16, 16, Rgb(8.0f));
  const Image test = constant(16, 16, Rgb(16.0f));
  for (const float value : flip_map(test, reference)) EXPECT_EQ(value, 0.0f);  // both white
  for (const float value : hdr_flip_map(test, reference, flip_exposures(reference))) EXPECT_GT(value, 0.05f);
}

}  // namespace
}  // namespace relume
