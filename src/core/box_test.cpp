#include "core/box.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

Box box_of(const Vec3& low, const Vec3& high) {
  Box box;
  box.add(low);
  box.add(high);
  return box;
}

TEST(Box, BeginsEmpty) {
  Box box;
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box.diagonal(), 0);
  box.add(Box{});
  EXPECT_TRUE(box.empty());
}

TEST(Box, HoldsItsPoints) {
  Box box;
  box.add(Vec3(1, 2, 3));
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.center(), Vec3(1, 2, 3));
  EXPECT_EQ(box.extent(), Vec3(0));
  box.add(Vec3(4, -2, 3));
  EXPECT_EQ(box.low, Vec3(1, -2, 3));
  EXPECT_EQ(box.high, Vec3(4, 2, 3));
  EXPECT_EQ(box.center(), Vec3(2.5f, 0, 3));
  EXPECT_EQ(box.extent(), Vec3(3, 4, 0));
  EXPECT_EQ(box.diagonal(), 5);
}

TEST(Box, HoldsOtherBoxes) {
  Box box = box_of({0, 0, 0}, {1, 1, 1});
  box.add(box_of({-1, 0.5f, 2}, {0.5f, 0.75f, 3}));
  EXPECT_EQ(box.low, Vec3(-1, 0, 0));
  EXPECT_EQ(box.high, Vec3(1, 1, 3));
  box.add(Box{});
  EXPECT_EQ(box.low, Vec3(-1, 0, 0));
  EXPECT_EQ(box.high, Vec3(1, 1, 3));
}

TEST(Box, TransformsByItsCorners) {
  // Maps +X to +Y and +Y to -X, scales both by two, then translates.
  Mat4 turn(1);
  turn[0] = Vec4(0, 2, 0, 0);
  turn[1] = Vec4(-2, 0, 0, 0);
  turn[3] = Vec4(10, 20, 30, 1);
  const Box box = transformed(box_of({1, 2, 3}, {4, 6, 5}), turn);
  EXPECT_EQ(box.low, Vec3(-2, 22, 33));
  EXPECT_EQ(box.high, Vec3(6, 28, 35));
  EXPECT_TRUE(transformed(Box{}, turn).empty());
}

}  // namespace
}  // namespace relume
