#include "builtin_scenes/portals.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

/// Whether a line has all of `left` strictly on one side and all of `right` strictly on the other: their differences
/// lie in an open half-plane. Lines within 1e-9 radians of touching an edge do not count.
bool are_separable(const std::vector<Vec2>& left, const std::vector<Vec2>& right) {
  constexpr double kTurn = 6.283185307179586;
  std::vector<double> angles;
  for (const Vec2& l : left) {
    for (const Vec2& r : right) {
      const double x = static_cast<double>(l.x) - static_cast<double>(r.x);
      const double y = static_cast<double>(l.y) - static_cast<double>(r.y);
      if (x == 0 && y == 0) return false;
      angles.push_back(std::atan2(y, x));
    }
  }
  std::sort(angles.begin(), angles.end());
  double widest_gap = angles.front() + kTurn - angles.back();
  for (size_t i = 1; i < angles.size(); ++i) widest_gap = std::max(widest_gap, angles[i] - angles[i - 1]);
  return widest_gap > kTurn / 2 + 1e-9;
}

/// Follows all sequences of portals that a line can cross.
class Search {
 public:
  Search(uint32_t room_count, const std::vector<Portal>& portals) : portals_(portals), of_room_(room_count) {
    for (uint32_t i = 0; i < portals.size(); ++i) {
      for (const uint32_t room : portals[i].rooms) of_room_[room].push_back(i);
    }
  }

  std::vector<uint32_t> from(uint32_t room) {
    seen_.assign(of_room_.size(), false);
    crossed_.assign(of_room_.size(), false);
    visit(room);
    std::vector<uint32_t> rooms;
    for (uint32_t i = 0; i < seen_.size(); ++i) {
      if (seen_[i]) rooms.push_back(i);
    }
    return rooms;
  }

 private:
  void visit(uint32_t room) {
    seen_[room] = true;
    crossed_[room] = true;  // a line does not return to a convex room
    for (const uint32_t i : of_room_[room]) {
      const Portal& portal = portals_[i];
      const bool ahead = portal.rooms[0] == room;
      const uint32_t next = portal.rooms[ahead ? 1 : 0];
      if (crossed_[next]) continue;
      left_.push_back(ahead ? portal.left : portal.right);
      right_.push_back(ahead ? portal.right : portal.left);
      if (are_separable(left_, right_)) visit(next);
      left_.pop_back();
      right_.pop_back();
    }
    crossed_[room] = false;
  }

  const std::vector<Portal>& portals_;
  std::vector<std::vector<uint32_t>> of_room_;
  std::vector<bool> seen_;
  std::vector<bool> crossed_;  ///< on the current sequence
  std::vector<Vec2> left_;     ///< ends of the current sequence
  std::vector<Vec2> right_;
};

}  // namespace

std::vector<std::vector<uint32_t>> visible_rooms(uint32_t room_count, const std::vector<Portal>& portals) {
  Search search(room_count, portals);
  std::vector<std::vector<uint32_t>> visible;
  for (uint32_t room = 0; room < room_count; ++room) visible.push_back(search.from(room));
  return visible;
}

}  // namespace relume
