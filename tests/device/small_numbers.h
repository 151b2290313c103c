// A kernel whose operands and results are denormal numbers.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/hd.h"
#include "core/view.h"

namespace relume::testing {

/// Results for the operands a and b.
struct SmallNumberResults {
  float sum;
  float difference;
  float product;
  float quotient;
  float root;  ///< of |a|
  float least;
  float greatest;
  float magnitude;  ///< |a|
  float negated;    ///< −a
  float rounded;    ///< a / 3 in double precision, rounded to a float
  double widened;   ///< a
  double scaled;    ///< a · 2^-900, a denormal double for small a
  double divided;   ///< the same divided by 3
};

/// Element (x, y) computes with the y-th and the x-th value.
struct SmallNumbersKernel {
  View<const float> values;
  View<SmallNumberResults> results;  ///< in rows

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const float a = values[y];
    const float b = values[x];
    const auto wide = static_cast<double>(a);
    const double scaled = wide * 0x1p-900;
    SmallNumberResults& r = results[y * values.size + x];
    r.sum = a + b;
    r.difference = a - b;
    r.product = a * b;
    r.quotient = a / b;
    r.magnitude = std::fabs(a);
    r.root = std::sqrt(std::fabs(a));
    r.least = std::fmin(a, b);
    r.greatest = std::fmax(a, b);
    r.negated = -a;
    r.rounded = static_cast<float>(wide / 3.0);
    r.widened = wide;
    r.scaled = scaled;
    r.divided = scaled / 3.0;
  }
};

}  // namespace relume::testing
