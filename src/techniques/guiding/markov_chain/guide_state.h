// State of a chain that guides paths: exponentially weighted sums over the targets that it accepted ([Alber25]). A
// target is a point, so the lobe follows its parallax from every vertex of the cell.
#pragma once

#include "core/hash.h"
#include "core/vec.h"
#include "sampling/von_mises_fisher.h"

namespace relume {

/// Limits of a state's weight. Beyond them, sums of products could overflow or lose all precision; such a state is
/// empty. They also bound whatever bits a damaged table has.
inline constexpr float kLeastStateWeight = 1e-30f;
inline constexpr float kMostStateWeight = 1e30f;

struct GuideState {
  Vec3 target{0};           ///< weighted sum of the targets' positions, metres
  float weight = 0;         ///< sum of weights, the mean score; 0: empty
  float cosine = 0;         ///< weighted sum of the cosines between new targets and the mean
  uint16_t motion[3] = {};  ///< motion of the last target per frame, metres (pack_motion())
  uint16_t count = 0;       ///< number of accepted targets, with a limit
  uint32_t frame = 0;       ///< frame of the last target
};
static_assert(sizeof(GuideState) == 32);

/// A number rounded to the upper 16 bits of a float; 0 if it is not finite.
RELUME_HD inline uint16_t pack_motion(float x) {
  if (!(std::fabs(x) < 1e30f)) return 0;
  return static_cast<uint16_t>((float_bits(x) + 0x8000u) >> 16);
}
RELUME_HD inline float unpack_motion(uint16_t bits) { return bits_float(uint32_t{bits} << 16); }

RELUME_HD inline void set_motion(GuideState& state, const Vec3& motion) {
  for (int c = 0; c < 3; ++c) state.motion[c] = pack_motion(motion[c]);
}

/// Whether the state has a weight and finite numbers.
RELUME_HD inline bool is_usable(const GuideState& s) {
  return s.weight >= kLeastStateWeight && s.weight <= kMostStateWeight && is_finite(s.target) && s.cosine >= 0.0f &&
         s.cosine <= kMostStateWeight;
}

/// Mean position of the targets. The state must be usable.
RELUME_HD inline Vec3 mean_target(const GuideState& s) { return s.target / s.weight; }

/// Moves the targets by their motion up to `frame`, over at most kMostMovedFrames frames: objects stop.
RELUME_HD inline GuideState moved_to_frame(GuideState s, uint32_t frame) {
  constexpr uint32_t kMostMovedFrames = 16;
  const auto age = static_cast<float>(relume::min(frame - s.frame, kMostMovedFrames));
  for (int c = 0; c < 3; ++c) s.target[c] += s.weight * age * unpack_motion(s.motion[c]);
  return s;
}

/// Prior of the mean cosine: its weight grows as the solid angle of a cell, seen from the target.
struct GuidePrior {
  float strength = 0.2f;
  float edge = 0;  ///< of a cell, metres
};

/// Mean cosine r of a state seen from `distance` metres: N² c / (N² + prior (edge / distance)²).
RELUME_HD inline float mean_cosine(const GuideState& s, const GuidePrior& prior, float distance) {
  constexpr float kLeastPrior = 1e-4f;
  const float n2 = static_cast<float>(s.count) * static_cast<float>(s.count);
  const float doubt = relume::max(prior.strength * sqr(prior.edge / distance), kLeastPrior);
  return clamp(n2 * clamp(s.cosine / s.weight, 0.0f, 1.0f) / (n2 + doubt), 0.0f, 1.0f);
}

/// The lobe of a state at `p`. Returns false if it has none: the state is not usable, or its target is at `p`.
RELUME_HD inline bool lobe_at(const GuideState& s, const Vec3& p, const GuidePrior& prior, VonMisesFisher& lobe) {
  if (!is_usable(s)) return false;
  const Vec3 to_target = mean_target(s) - p;
  const float distance = glm::length(to_target);
  if (!(distance > 0.0f) || !is_finite(distance)) return false;
  lobe.axis = to_target / distance;
  lobe.concentration = VonMisesFisher::concentration_of(mean_cosine(s, prior, distance));
  return std::fabs(glm::dot(lobe.axis, lobe.axis) - 1.0f) < 1e-3f;  // false for denormal distances and NaN
}

/// Rates of a chain.
struct ChainRates {
  float least_alpha = 0.01f;   ///< least share of a new sample in the sums
  uint32_t most_count = 1024;  ///< largest count; at most 65,535

  RELUME_HD uint32_t next_count(uint32_t count) const { return relume::min(count + 1, most_count); }
  RELUME_HD float alpha(uint32_t count) const {
    return relume::max(1.0f / static_cast<float>(relume::max(count, 1u)), least_alpha);
  }
};

/// Adds a target at `target` metres with the score `score`, found from `p`, to a usable or empty state. Sets all
/// members except the motion.
RELUME_HD inline void add_target(GuideState& s, const ChainRates& rates, const Vec3& p, const Vec3& target, float score,
                                 uint32_t frame) {
  if (!is_usable(s)) {
    s.count = 0;
    s.weight = s.cosine = 0;
    s.target = Vec3(0);
  }
  s.count = static_cast<uint16_t>(rates.next_count(s.count));
  const float alpha = rates.alpha(s.count);
  s.weight += alpha * (score - s.weight);
  s.target += alpha * (score * target - s.target);
  const Vec3 to_target = target - p;
  const Vec3 to_mean = mean_target(s) - p;
  const float lengths = glm::length(to_target) * glm::length(to_mean);
  const float cosine = lengths > 0.0f ? clamp(glm::dot(to_target, to_mean) / lengths, 0.0f, 1.0f) : 0.0f;
  s.cosine += alpha * (score * cosine - s.cosine);
  s.cosine = clamp(s.cosine, 0.0f, s.weight);
  s.frame = frame;
}

/// Whether the light of a state has vanished: a direction close to the axis of its lobe found almost none. The cosine
/// to the axis must be at least 0.9 + 0.1 r. For the narrowest lobes, one direction in ten fulfils this.
RELUME_HD inline bool has_vanished(const GuideState& s, const GuidePrior& prior, const Vec3& p, const Vec3& direction,
                                   float score) {
  if (score > 1e-3f * s.weight) return false;
  const Vec3 to_mean = mean_target(s) - p;
  const float distance = glm::length(to_mean);
  if (!(distance > 0.0f)) return true;
  constexpr float kMostMeanCosine = 0.9999f;
  const float r = relume::min(mean_cosine(s, prior, distance), kMostMeanCosine);
  return glm::dot(direction, to_mean) >= distance * (0.9f + 0.1f * r);
}

}  // namespace relume
