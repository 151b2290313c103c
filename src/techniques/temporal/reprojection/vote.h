// Depth-test votes of stored samples for pixels, and rejections, as keys of which the smallest wins.
#pragma once

#include "core/hash.h"
#include "techniques/temporal/reprojection/reject_reason.h"

namespace relume {

inline constexpr uint64_t kNoVote = ~uint64_t{0};

/// A depth-test vote of a stored sample for a pixel, as a key whose minimum wins: the least depth (metres), then the
/// lowest index of a stored sample.
RELUME_HD inline uint64_t vote_of(float depth, uint32_t stored_sample) {
  return (static_cast<uint64_t>(float_bits(depth)) << 32) | stored_sample;
}

/// Flag of a rejection, which makes it larger than every vote. A pixel without votes keeps the nearest rejection.
inline constexpr uint64_t kRejected = uint64_t{1} << 63;
RELUME_HD inline uint64_t rejection_of(float depth, RejectReason reject_reason) {
  return kRejected | vote_of(depth, static_cast<uint32_t>(reject_reason));
}
RELUME_HD inline bool is_vote(uint64_t vote) { return vote < kRejected; }

/// Flag of a vote's stored sample: the light of cells is looked up.
inline constexpr uint32_t kLooksUp = 1u << 31;
/// Index of the stored sample of a vote.
RELUME_HD inline uint32_t sample_of(uint64_t vote) { return static_cast<uint32_t>(vote) & ~kLooksUp; }

/// The reason in a pixel's smallest vote.
RELUME_HD inline RejectReason reason_of(uint64_t vote) {
  if (is_vote(vote)) return static_cast<uint32_t>(vote) & kLooksUp ? RejectReason::looked_up : RejectReason::none;
  return vote == kNoVote ? RejectReason::empty : static_cast<RejectReason>(static_cast<uint32_t>(vote));
}

}  // namespace relume
