#include "builtin_scenes/portals.h"

#include <vector>

#include <gtest/gtest.h>

namespace relume {
namespace {

using Rooms = std::vector<uint32_t>;

/// A door from room `from` to the next one, in the wall at x, from z0 to z1.
Portal door(uint32_t from, float x, float z0, float z1) { return {{from, from + 1}, {x, z1}, {x, z0}}; }

TEST(Portals, AlignedDoorsShowAllRooms) {
  const auto visible = visible_rooms(4, {door(0, 4, 1, 2), door(1, 8, 1, 2), door(2, 12, 1.9f, 3)});
  for (const Rooms& rooms : visible) EXPECT_EQ(rooms, (Rooms{0, 1, 2, 3}));
}

TEST(Portals, LinesCannotFollowAZigzag) {
  const auto visible = visible_rooms(4, {door(0, 4, 1, 2), door(1, 8, 8, 9), door(2, 12, 1, 2)});
  EXPECT_EQ(visible[0], (Rooms{0, 1, 2}));
  EXPECT_EQ(visible[1], (Rooms{0, 1, 2, 3}));
  EXPECT_EQ(visible[2], (Rooms{0, 1, 2, 3}));
  EXPECT_EQ(visible[3], (Rooms{1, 2, 3}));
}

/// Lines through the first and the last door pass the wall between them at z from 0.5 to 1.5.
TEST(Portals, GrazingLinesDecide) {
  const Portal first = door(0, 4, -1, 0);
  const Portal last = door(2, 12, 2, 3);
  EXPECT_EQ(visible_rooms(4, {first, door(1, 8, 1.49f, 5), last})[0], (Rooms{0, 1, 2, 3}));
  EXPECT_EQ(visible_rooms(4, {first, door(1, 8, 1.51f, 5), last})[0], (Rooms{0, 1, 2}));
  EXPECT_EQ(visible_rooms(4, {first, door(1, 8, -5, 0.49f), last})[0], (Rooms{0, 1, 2}));
}

/// Two doors in one wall: a line through the first does not return through the second.
TEST(Portals, LinesDoNotTurnBack) {
  const Portal there = {{0, 1}, {4, 2}, {4, 1}};
  const Portal back = {{1, 2}, {4, 12}, {4, 13}};
  const auto visible = visible_rooms(3, {there, back});
  EXPECT_EQ(visible[0], (Rooms{0, 1}));
  EXPECT_EQ(visible[1], (Rooms{0, 1, 2}));
  EXPECT_EQ(visible[2], (Rooms{1, 2}));
}

TEST(Portals, ClosedRoomsSeeThemselves) { EXPECT_EQ(visible_rooms(2, {}), (std::vector<Rooms>{{0}, {1}})); }

}  // namespace
}  // namespace relume
