#include "viewer/render/inspect.h"

#include <gtest/gtest.h>

namespace relume::viewer {
namespace {

TEST(Inspect, DescribesPixels) {
  ViewerFrame frame;
  frame.width = 4;
  frame.height = 2;
  frame.radiance.assign(8, Rgb(0));
  frame.radiance[6] = {0.25f, 1, 2.5f};
  EXPECT_EQ(describe_pixel(frame, {0.6f, 0.9f}), "(2, 1)  RGB 0.25 1 2.5");
  EXPECT_EQ(describe_pixel(frame, {1, -3}), "(3, 0)  RGB 0 0 0") << "the nearest pixel";
  frame.buffer = "normal";
  frame.channels = "XYZ";
  frame.values.assign(8, {0, kInfinity, -1});
  EXPECT_EQ(describe_pixel(frame, {0, 0}), "(0, 0)  RGB 0 0 0  \xc2\xb7  normal X 0 Y inf Z -1");
  frame.buffer = "depth";
  frame.channels = "Z";
  EXPECT_EQ(describe_pixel(frame, {0, 0}), "(0, 0)  RGB 0 0 0  \xc2\xb7  depth 0") << "one channel needs no name";
}

TEST(Inspect, RangeIgnoresOutliers) {
  std::vector<Rgb> values;
  for (int i = 0; i < 1000; ++i) values.emplace_back(static_cast<float>(i), 0, 0);
  values.emplace_back(1e9f, 0, 0);
  values.emplace_back(kInfinity, 0, 0);
  const Vec2 range = value_range(values, 1);
  EXPECT_NEAR(range.x, 10, 2);
  EXPECT_NEAR(range.y, 990, 2);
  EXPECT_EQ(value_range(std::vector<Rgb>(4, Rgb(3)), 1), Vec2(0, 3));
  EXPECT_EQ(value_range({}, 1), Vec2(0, 1));
}

}  // namespace
}  // namespace relume::viewer
