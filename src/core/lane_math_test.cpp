#include "core/lane_math.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

TEST(Math, UpperAngleIsThatOfTheStandardLibrary) {
  double worst = 0;
  for (int i = 0; i <= 20000; ++i) {
    const double angle = M_PI * i / 20000;
    for (const double length : {1e-20, 1e-3, 1.0, 7e9}) {
      const auto y = static_cast<float>(std::max(0.0, length * std::sin(angle)));
      const auto x = static_cast<float>(length * std::cos(angle));
      const double exact = std::atan2(double(y), double(x));
      worst = std::max(worst, std::abs(upper_angle(y, x) - exact) / std::max(exact, 1e-30));
    }
  }
  EXPECT_LT(worst, 3e-7);
  EXPECT_EQ(upper_angle(0.0f, 0.0f), 0.0f);
  EXPECT_EQ(upper_angle(0.0f, 2.0f), 0.0f);
  EXPECT_EQ(upper_angle(0.0f, -2.0f), kPi);
  EXPECT_EQ(upper_angle(3.0f, 0.0f), kPi / 2);
}

TEST(Math, SinesAndCosinesAreThoseOfTheStandardLibrary) {
  for (int i = 0; i <= 200000; ++i) {
    const auto x = static_cast<float>(M_PI * i / 200000);
    float sine;
    float cosine;
    sine_and_cosine(x, sine, cosine);
    EXPECT_NEAR(sine, std::sin(double(x)), 3e-7 * (x < kPi / 2 ? std::sin(double(x)) : 1.0));
    EXPECT_NEAR(cosine, std::cos(double(x)), 3e-7);
  }
}

TEST(Math, LanesHaveTheBitsOfFloats) {
  Lanes x;
  Lanes y;
  for (uint32_t i = 0; i < kLanes; ++i) {
    x.v[i] = static_cast<float>(std::cos(0.37 * i)) * 3.0f;
    y.v[i] = 0.3f * static_cast<float>(i);
  }
  const Lanes angle = upper_angle(y, x);
  Lanes sine;
  Lanes cosine;
  sine_and_cosine(angle, sine, cosine);
  for (uint32_t i = 0; i < kLanes; ++i) {
    float s;
    float c;
    sine_and_cosine(upper_angle(y[i], x[i]), s, c);
    EXPECT_EQ(angle[i], upper_angle(y[i], x[i]));
    EXPECT_EQ(sine[i], s);
    EXPECT_EQ(cosine[i], c);
  }
}

}  // namespace
}  // namespace relume
