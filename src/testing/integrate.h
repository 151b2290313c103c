// Adaptive quadrature over rectangles, for expected counts and albedos in tests.
#pragma once

#include <cmath>

namespace relume::testing {

struct Rectangle {
  double x0, y0, x1, y1;
};

/// 3 × 3 Gauss-Legendre rule.
template <typename F>
double gauss_3x3(const F& f, const Rectangle& r) {
  constexpr double kNodes[3] = {0.112701665379258311, 0.5, 0.887298334620741689};
  constexpr double kWeights[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      sum += kWeights[i] * kWeights[j] * f(r.x0 + (r.x1 - r.x0) * kNodes[i], r.y0 + (r.y1 - r.y0) * kNodes[j]);
    }
  }
  return sum * (r.x1 - r.x0) * (r.y1 - r.y0);
}

/// Integral of f over a rectangle. Halves it in both directions, at least `least` and up to `depth` times, until the
/// four parts agree with the whole within `tolerance` (absolute). Discontinuities are resolved to 2^-depth of an edge.
/// A part that extends into a cell by less than a tenth of 2^-least of its edge may be missed.
template <typename F>
double integrate(const F& f, const Rectangle& r, double tolerance, int depth, int least = 0) {
  const auto refine = [&](const auto& self, const Rectangle& cell, double whole, int level) -> double {
    const double xm = 0.5 * (cell.x0 + cell.x1);
    const double ym = 0.5 * (cell.y0 + cell.y1);
    const Rectangle quarters[4] = {
        {cell.x0, cell.y0, xm, ym}, {xm, cell.y0, cell.x1, ym}, {cell.x0, ym, xm, cell.y1}, {xm, ym, cell.x1, cell.y1}};
    double parts[4];
    double sum = 0;
    for (int i = 0; i < 4; ++i) sum += parts[i] = gauss_3x3(f, quarters[i]);
    if (level <= 0 || (depth - level >= least && std::fabs(sum - whole) <= tolerance)) return sum;
    sum = 0;
    for (int i = 0; i < 4; ++i) sum += self(self, quarters[i], parts[i], level - 1);
    return sum;
  };
  return refine(refine, r, gauss_3x3(f, r), depth);
}

/// The same over [0, 1)², first cut into `n` × `n` cells, so that narrow peaks are not missed.
template <typename F>
double integrate_square(const F& f, int n, double tolerance, int depth) {
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      sum += integrate(f, {double(i) / n, double(j) / n, double(i + 1) / n, double(j + 1) / n}, tolerance / (n * n),
                       depth);
    }
  }
  return sum;
}

}  // namespace relume::testing
