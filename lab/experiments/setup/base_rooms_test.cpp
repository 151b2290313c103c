#include "experiments/setup/base_rooms.h"

#include <iterator>
#include <optional>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr uint32_t kSeeds = 10;

/// Only rooms with dim lamps, one in ten, may be missing.
TEST(BaseRooms, EveryKindIsInEveryBase) {
  std::set<std::string> names;
  for (const BaseLamps lamps : kBaseLamps) {
    names.insert(name_of(lamps));
    for (uint32_t seed = 1; seed <= kSeeds && lamps != BaseLamps::dim; ++seed)
      EXPECT_TRUE(base_room_view(seed, lamps)) << seed << " " << name_of(lamps);
  }
  EXPECT_EQ(names.size(), std::size(kBaseLamps));
}

TEST(BaseRooms, TheCameraStandsInTheRoomAndLooksAlongIt) {
  for (const BaseLamps lamps : kBaseLamps) {
    const std::optional<BaseRoomView> view = base_room_view(3, lamps);
    if (!view) continue;
    EXPECT_EQ(view->room.lamps, lamps);
    const Mat4& to_world = view->scene.camera->to_world;
    const Vec2 eye(to_world[3].x, to_world[3].z);
    const Vec2 ahead(-to_world[2].x, -to_world[2].z);
    const Vec2 beyond = eye + 2.0f * ahead;  // the shortest side is 3 m
    for (int axis = 0; axis < 2; ++axis) {
      for (const Vec2& p : {eye, beyond}) {
        EXPECT_GT(p[axis], view->room.low[axis]) << view->scene.name;
        EXPECT_LT(p[axis], view->room.high[axis]) << view->scene.name;
      }
    }
    EXPECT_GT(to_world[3].y, 1.5f);
  }
}

}  // namespace
}  // namespace relume
