#include "ranks/frame_dealer.h"

#include <algorithm>

namespace relume::ranks {
namespace {

/// A segment has at most this part of the frames left per rank.
constexpr size_t kPartsPerRank = 2;

}  // namespace

FrameDealer::FrameDealer(size_t first, size_t frames, int ranks, size_t longest)
    : next_(first),
      ranks_(static_cast<size_t>(ranks)),
      longest_(std::max(longest, size_t{1})),
      received_(frames, false),
      missing_(frames - first),
      before_(first) {
  std::fill_n(received_.begin(), first, true);
}

std::optional<Segment> FrameDealer::next(int rank) {
  const size_t left = received_.size() - next_;
  if (left > 0) {
    // Images wait in memory until those before them are written.
    if (next_ - before_ >= 2 * ranks_ * longest_) return std::nullopt;
    const Segment segment{next_, std::clamp(left / (kPartsPerRank * ranks_), size_t{1}, longest_)};
    next_ += segment.count;
    flights_.push_back({rank, segment});
    return segment;
  }
  for (Flight& flight : flights_) {
    const std::optional<Segment> rest = rest_of(flight.segment);
    if (flight.again || !rest) continue;
    flight.again = true;
    flights_.push_back({rank, *rest, true});
    return rest;
  }
  return std::nullopt;
}

/// The frames from the first one that is missing on.
std::optional<Segment> FrameDealer::rest_of(const Segment& segment) const {
  const size_t end = segment.first + segment.count;
  size_t first = segment.first;
  while (first < end && received_[first]) ++first;
  if (first == end) return std::nullopt;
  return Segment{first, end - first};
}

bool FrameDealer::received(size_t frame) {
  if (frame >= received_.size() || received_[frame]) return false;
  received_[frame] = true;
  --missing_;
  while (before_ < received_.size() && received_[before_]) ++before_;
  return true;
}

void FrameDealer::finished(int rank) {
  std::erase_if(flights_, [&](const Flight& flight) { return flight.rank == rank; });
}

}  // namespace relume::ranks
