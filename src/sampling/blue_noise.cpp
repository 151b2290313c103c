#include "sampling/blue_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace relume {
namespace {

constexpr uint32_t kEdge = kBlueNoiseEdge;
constexpr uint32_t kCells = kEdge * kEdge;

/// Points on a torus, and the crowding of each cell: the sum of a Gaussian about every point.
class Pattern {
 public:
  Pattern() {
    constexpr float kDeviation = 1.9f;  // pixels; [Ulichney93] finds 1.5; larger values are more regular
    for (uint32_t y = 0; y < kEdge; ++y) {
      for (uint32_t x = 0; x < kEdge; ++x) {
        const auto dx = static_cast<float>(std::min(x, kEdge - x));
        const auto dy = static_cast<float>(std::min(y, kEdge - y));
        falloff_[y * kEdge + x] = std::exp(-(dx * dx + dy * dy) / (2.0f * kDeviation * kDeviation));
      }
    }
  }

  void set(uint32_t cell, bool point) {
    points_[cell] = point;
    const float sign = point ? 1.0f : -1.0f;
    const uint32_t cx = cell % kEdge;
    const uint32_t cy = cell / kEdge;
    for (uint32_t y = 0; y < kEdge; ++y) {
      const float* row = &falloff_[(y + kEdge - cy) % kEdge * kEdge];
      for (uint32_t x = 0; x < kEdge; ++x) crowding_[y * kEdge + x] += sign * row[(x + kEdge - cx) % kEdge];
    }
  }
  /// The point in the tightest cluster.
  uint32_t tightest() const { return extreme(true, 1.0f); }
  /// The empty cell in the largest void.
  uint32_t emptiest() const { return extreme(false, -1.0f); }

 private:
  uint32_t extreme(bool point, float sign) const {
    uint32_t best = kCells;
    for (uint32_t i = 0; i < kCells; ++i) {
      if (points_[i] == point && (best == kCells || sign * crowding_[i] > sign * crowding_[best])) best = i;
    }
    return best;
  }

  std::array<float, kCells> falloff_{};
  std::array<float, kCells> crowding_{};
  std::array<bool, kCells> points_{};
};

/// Evenly spreads points over a tenth of all cells: points move from the tightest cluster to the largest void until
/// none moves.
std::vector<uint32_t> spread_points(Pattern& pattern) {
  std::vector<uint32_t> points;
  for (uint32_t i = 0; points.size() < kCells / 10; ++i) {
    const uint32_t cell = hash(i, 0x3c6ef372u) % kCells;
    if (std::find(points.begin(), points.end(), cell) != points.end()) continue;
    points.push_back(cell);
    pattern.set(cell, true);
  }
  for (;;) {
    const uint32_t from = pattern.tightest();
    pattern.set(from, false);
    const uint32_t to = pattern.emptiest();
    pattern.set(to, true);
    if (to == from) return points;
    *std::find(points.begin(), points.end(), from) = to;
  }
}

std::vector<uint16_t> make_tile() {
  std::vector<uint16_t> ranks(kCells);
  Pattern pattern;
  const std::vector<uint32_t> first = spread_points(pattern);
  Pattern rest = pattern;
  for (size_t rank = first.size(); rank-- > 0;) {
    const uint32_t cell = pattern.tightest();
    pattern.set(cell, false);
    ranks[cell] = static_cast<uint16_t>(rank);
  }
  for (size_t rank = first.size(); rank < kCells; ++rank) {
    const uint32_t cell = rest.emptiest();
    rest.set(cell, true);
    ranks[cell] = static_cast<uint16_t>(rank);
  }
  return ranks;
}

}  // namespace

View<const uint16_t> blue_noise_tile() {
  static const std::vector<uint16_t> tile = make_tile();
  return view_of(tile);
}

View<const uint16_t> blue_noise_tile(Array<uint16_t>& array) {
  const View<const uint16_t> tile = blue_noise_tile();
  if (array.empty()) array.assign({tile.data, tile.size});
  return array.view();
}

}  // namespace relume
