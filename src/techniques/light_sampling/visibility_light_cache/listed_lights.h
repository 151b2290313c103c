// Weights of the lights of a list, which may be at infinity.
#pragma once

#include "techniques/light_sampling/visibility_light_cache/light_shares.h"

namespace relume {

/// LightCandidates with the visibility of lights at infinity. `compact` has an element for each light of the list.
template <typename IdAt>
struct ListedLights : LightCandidates<IdAt> {
  bool lists_infinite;                    ///< otherwise all lights are finite
  const View<const LightShares>& shares;  ///< with the visibility of lights at infinity, by region; empty: 1
  uint32_t region;

  /// As LightCandidates::weigh().
  template <typename Use>
  RELUME_HD float weigh(const SurfacePoint& sp, const Use& use) const {
    if (!lists_infinite) return LightCandidates<IdAt>::weigh(sp, use);
    const LightReceiver receiver = make_light_receiver(this->ltc, sp.position, sp.frame, sp.wo_local, sp.bsdf);
    float sum = 0;
    for_each_importance(
        receiver, this->lights, this->compact, this->count, this->id_at, [&](uint32_t i, float importance) {
          const LightId id = this->id_at(i);
          const float weight = id < this->lights.first_infinite ? importance : from_infinity(receiver, id);
          use(i, weight);
          sum += weight;
        });
    if (sum > 0.0f && is_finite(sum)) return sum;
    for (uint32_t i = 0; i < this->count; ++i) use(i, 1.0f);
    return static_cast<float>(this->count);
  }

 private:
  RELUME_HD float from_infinity(const LightReceiver& receiver, LightId id) const {
    const float importance = infinite_importance(receiver, this->lights, id);
    if (region >= shares.size) return importance;
    return shares[region].visibility.of[InfinityVisibility::index_of(id - this->lights.first_infinite)] * importance;
  }
};

}  // namespace relume
