// χ² tests over the unit square and over directions: sample counts against integrals of their density.
#pragma once

#include <numeric>
#include <vector>

#include "core/frame.h"
#include "core/vec.h"
#include "testing/chi2.h"
#include "testing/integrate.h"

namespace relume::testing {

/// Counts over a grid of n × n bins of the unit square, plus one for samples outside.
class Histogram {
 public:
  explicit Histogram(int n) : n_(n), counts_(static_cast<size_t>(n * n) + 1, 0) {}

  void add(double x, double y) { ++counts_[static_cast<size_t>(index(x)) + static_cast<size_t>(index(y) * n_)]; }
  void add_outside() { ++counts_.back(); }

  /// Tests against `density(x, y)` over the unit square; the density missing from one is expected outside. `depth` and
  /// `least` are parameters of integrate(), `max_strays` of chi2_test().
  template <typename F>
  Chi2Result test(const F& density, int depth = 5, int least = 1, double max_strays = 0) const {
    const double tolerance = 0.02 / static_cast<double>(total());
    return test_against(integrals(density, n_, tolerance, depth, least), max_strays);
  }

  /// The same against integrals of a density over the bins, which several histograms may share.
  Chi2Result test_against(std::vector<double> expected, double max_strays = 0) const {
    double inside = 0;
    for (const double e : expected) inside += e;
    // Quadrature has an error of a few millionths; a smaller remainder counts as zero.
    expected.push_back(1.0 - inside > 2e-5 ? 1.0 - inside : 0.0);
    for (double& e : expected) e *= static_cast<double>(total());
    return chi2_test(counts_, expected, max_strays);
  }

  /// Integral of the density over each bin.
  template <typename F>
  static std::vector<double> integrals(const F& density, int n, double tolerance, int depth, int least = 1) {
    std::vector<double> result;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        result.push_back(integrate(density, {double(i) / n, double(j) / n, double(i + 1) / n, double(j + 1) / n},
                                   tolerance, depth, least));
      }
    }
    return result;
  }

 private:
  uint64_t total() const { return std::accumulate(counts_.begin(), counts_.end(), uint64_t{0}); }
  int index(double x) const {
    const int i = static_cast<int>(x * n_);
    return i < 0 ? 0 : (i < n_ ? i : n_ - 1);
  }

  int n_;
  std::vector<uint64_t> counts_;
};

/// The coordinate axes.
inline Frame local_frame() { return {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}; }

/// Coordinates in [0, 1)² of all directions about an axis. The first grows with the logarithm of the sine of half the
/// angle, in units of `width`. Densities that narrow about the axis then fill many bins, as do wide ones.
struct DirectionChart {
  Frame frame = local_frame();
  double width = 1;

  Vec2 coordinates(const Vec3& w) const {
    const double s = 0.5 * glm::length(w - frame.n);  // sine of half the angle
    const double phi = std::atan2(glm::dot(w, frame.b), glm::dot(w, frame.t)) / (2.0 * M_PI);
    return {static_cast<float>(std::log1p(s / width) / std::log1p(1.0 / width)),
            static_cast<float>(phi < 0 ? phi + 1.0 : phi)};
  }

  /// Direction at (x, y), and the solid angle per area of the square.
  Vec3 direction(double x, double y, double* solid_angle) const {
    const double range = std::log1p(1.0 / width);
    const double s = width * std::expm1(x * range);
    const double ds_dx = (width + s) * range;
    *solid_angle = 8.0 * M_PI * s * ds_dx;
    const double sin_theta = 2.0 * s * std::sqrt(std::fmax(0.0, 1.0 - s * s));
    const double phi = 2.0 * M_PI * y;
    const double cos_theta = 1.0 - 2.0 * s * s;
    Vec3 w;
    for (int c = 0; c < 3; ++c) {
      w[c] = static_cast<float>(sin_theta * (std::cos(phi) * frame.t[c] + std::sin(phi) * frame.b[c]) +
                                cos_theta * frame.n[c]);
    }
    return w;
  }

  /// Converts a density per solid angle to one over the square.
  template <typename F>
  auto density(const F& pdf_w) const {
    return [this, &pdf_w](double x, double y) {
      double solid_angle;
      const Vec3 w = direction(x, y, &solid_angle);
      return pdf_w(w) * solid_angle;
    };
  }
};

}  // namespace relume::testing
