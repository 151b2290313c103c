// The variance of short histories, which decides whether the filter gives them the light of their surface.
#include <gtest/gtest.h>

#include "techniques/denoise/svgf/testing/wall.h"

namespace relume {
namespace {

using testing::Wall;

constexpr uint32_t kApart = 8;  // pixels from window to window: more than the 7 × 7 of the estimate reach

/// One sample per pixel. Windows lie half a metre behind the wall, each a pixel alone. Neighbours differ by noise.
struct Facade : Wall {
  Facade() {
    for (uint32_t i = 0; i < kPixels; ++i) {
      const bool odd = (i % kWidth + i / kWidth) % 2 == 1;
      if (is_window(i % kWidth, i / kWidth)) {
        position[i].z = -0.5f;
        set(i, 1);
      } else {
        set(i, odd ? 3.0f : 0.0f);
      }
      count[i] = 1;
    }
  }

  static bool is_window(uint32_t x, uint32_t y) { return x % kApart == 4 && y % kApart == 4; }

  void set(uint32_t pixel, float value) {
    light[pixel] = Rgb(value);
    moments[pixel] = Vec2(value, value * value);
  }
};

TEST(SvgfVariance, ABlackSampleAloneOnItsPlaneReceivesTheLightOfItsSurface) {
  Facade facade;
  facade.set(20 * Wall::kWidth + 36, 0);
  facade.filter();
  EXPECT_GT(facade.at(1, 36, 20), 0.5f);
  EXPECT_LT(facade.at(1, 36, 20), 1.05f) << "light of the wall";
}

TEST(SvgfVariance, ABlackSampleAmongLitOnesReceivesTheirLight) {
  Wall wall;
  wall.count.assign(Wall::kPixels, 1);
  wall.light.assign(Wall::kPixels, Rgb(1));
  wall.light[20 * Wall::kWidth + 36] = Rgb(0);
  wall.moments[20 * Wall::kWidth + 36] = Vec2(0);
  wall.filter();
  EXPECT_GT(wall.at(1, 36, 20), 0.5f);
}

TEST(SvgfVariance, PixelsOnThePlaneAreMeasuredAlone) {
  Facade facade;
  facade.prepare();
  const float of_window = facade.at(kAtrousVariance, 36, 20);
  EXPECT_GT(of_window, 4 * 2.0f);  // that of the wall, 9/4, times 4
  EXPECT_LT(of_window, 4 * 2.5f);
  for (uint32_t i = 0; i < Wall::kPixels; ++i) {
    if (!Facade::is_window(i % Wall::kWidth, i / Wall::kWidth)) facade.set(i, 3);
  }
  facade.prepare();
  EXPECT_EQ(facade.at(kAtrousVariance, 38, 20), 0) << "a wall without noise, beside a window";
}

}  // namespace
}  // namespace relume
