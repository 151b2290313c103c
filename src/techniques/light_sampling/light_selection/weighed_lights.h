// Weights of few lights by their importance at a point.
#pragma once

#include "lights/light_importance.h"
#include "sampling/choose.h"
#include "scene/surface_point.h"

namespace relume {

/// Maximum number of lights weighed at a point.
inline constexpr uint32_t kMaxWeighedLights = 64;

/// Finite lights, and what their importance is computed from. `id_at(i)`: the light i < `count`. `compact` has an
/// element for each of these lights.
template <typename IdAt>
struct LightCandidates {
  const LtcTable& ltc;
  const LightsView& lights;
  const View<const CompactLight>& compact;
  uint32_t count;
  IdAt id_at;

  /// Calls use(i, weight) for each light, in order: with the importance at `sp`; then with 1 if the sum of importances
  /// is zero or overflows. Returns the sum of the weights, above 0 if there are lights.
  template <typename Use>
  RELUME_HD float weigh(const SurfacePoint& sp, const Use& use) const {
    const LightReceiver receiver = make_light_receiver(ltc, sp.position, sp.frame, sp.wo_local, sp.bsdf);
    const float sum = for_each_importance(receiver, lights, compact, count, id_at, use);
    if (sum > 0.0f && is_finite(sum)) return sum;
    for (uint32_t i = 0; i < count; ++i) use(i, 1.0f);
    return static_cast<float>(count);
  }
};

/// Weight of one light, and the sum over all candidates. `Candidates` below: LightCandidates, or a type with the same
/// count and weigh().
struct WeighedLight {
  float weight = 0;
  float sum = 0;
};

/// The weight of light `place` alone, so that a thread stores no others.
template <typename Candidates>
RELUME_HD inline WeighedLight weigh_light(const Candidates& candidates, const SurfacePoint& sp, uint32_t place) {
  WeighedLight result;
  result.sum = candidates.weigh(sp, [&](uint32_t i, float weight) {
    if (i == place) result.weight = weight;
  });
  return result;
}

/// Weights of all candidates, on the stack between a choice and its probability.
struct WeighedLights {
  // Zeroing a quarter of a kilobyte would cost more than most look-ups. The first is initialised, or compilers warn.
  float weights[kMaxWeighedLights];
  uint32_t count = 0;
  float sum = 0;  ///< of the weights; above 0 if there are lights

  template <typename Candidates>
  RELUME_HD WeighedLights(const Candidates& candidates, const SurfacePoint& sp) : count(candidates.count) {
    weights[0] = 0;
    sum = candidates.weigh(sp, [&](uint32_t i, float weight) { weights[i] = weight; });
  }

  /// Chooses a light with probability weight / sum.
  RELUME_HD uint32_t choose(ReusableNumber& n) const { return choose_by_weight(weights, count, sum, n); }
  RELUME_HD WeighedLight operator[](uint32_t i) const { return {weights[i], sum}; }
};

}  // namespace relume
