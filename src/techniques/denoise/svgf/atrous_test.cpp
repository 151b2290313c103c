#include "techniques/denoise/svgf/atrous.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

TEST(Atrous, ConstantsOfTapsHaveTheBitsOfTheirFormulas) {
  constexpr float kSpline[5] = {0.0625f, 0.25f, 0.375f, 0.25f, 0.0625f};
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      const int squared = dx * dx + dy * dy;
      EXPECT_EQ(atrous_detail::spline(squared), kSpline[dx + 2] * kSpline[dy + 2]) << dx << " " << dy;
      if (squared == 0) continue;
      const float distance = std::sqrt(static_cast<float>(squared));
      EXPECT_EQ(atrous_detail::inverse_distance(squared), 1.0f / distance) << dx << " " << dy;
    }
  }
}

}  // namespace
}  // namespace relume
