// Light selection among the lights recently visible from a region, by their unoccluded reflection at the point. A share
// of the samples explores all lights ([Dittebrandt20, §4]).
#pragma once

#include "sampling/choose.h"
#include "techniques/light_sampling/light_selection/infinite_lights.h"
#include "techniques/light_sampling/light_selection/light_selection.h"
#include "techniques/light_sampling/light_selection/weighed_lights.h"
#include "techniques/light_sampling/visibility_light_cache/exploration.h"
#include "techniques/light_sampling/visibility_light_cache/listed_lights.h"

namespace relume {

/// Maximum number of lights per bucket.
inline constexpr uint32_t kMaxBucketSize = kMaxWeighedLights;

/// A light on a region's list: id, and frames since it was last seen.
struct CachedLight {
  static constexpr uint32_t kAgeBits = 5;
  static constexpr uint32_t kMaxAge = (1u << kAgeBits) - 1;
  static constexpr uint32_t kNone = 0xffffffffu;  ///< an unused slot of a bucket

  RELUME_HD static constexpr uint32_t pack(LightId id, uint32_t age) { return (id << kAgeBits) | age; }
  RELUME_HD static constexpr LightId id(uint32_t packed) { return packed >> kAgeBits; }
  RELUME_HD static constexpr uint32_t age(uint32_t packed) { return packed & kMaxAge; }
};

/// Buckets of a region.
struct LightBuckets {
  uint32_t first = 0;  ///< first entry
  uint32_t count = 0;  ///< number of buckets; 0: no list
};

struct VisibilityLightCache {
  View<const LightBuckets> regions;
  View<const uint32_t> entries;      ///< CachedLight, `bucket_size` per bucket, sorted by id
  View<const float> bucket_weights;  ///< probabilities by bucket; a region's first index: its first entry / bucket_size
  uint32_t bucket_size = 32;
  float exploration = 0.1f;         ///< share of samples that explore
  bool learns_exploration = false;  ///< whether regions have their own share, in `shares`
  bool lists_infinite = false;      ///< whether regions list lights at infinity; otherwise they are a separate group
  View<const LightShares> shares;   ///< by region; empty: none
  ExplorationGrid all;              ///< over finite lights
  InfiniteLights infinite;          ///< its share is that of all samples, or if regions list them, of exploration
  LtcTable ltc;
  View<const CompactLight> compact;
  LightsView lights;

  /// [Dittebrandt20, algorithm 1]. Both strategies weigh one bucket, once.
  RELUME_HD LightSelection sample(const SurfacePoint& sp, ReusableNumber n) const {
    if (!lists_infinite && infinite.takes(n)) return infinite.sample(n);
    if (nothing_emits()) return {};
    const LightBuckets buckets = buckets_of(sp);
    const bool exploring = takes_share(buckets.count == 0 ? 1.0f : exploration_at(sp), n);
    LightId light = kNoLight;
    uint32_t bucket = 0;
    if (exploring) {
      const LightSelection explored = explore(sp.position, n);
      light = explored.light;
      n.u = explored.u;
      if (buckets.count > 0) bucket = light % buckets.count;
    } else {
      bucket = choose_by_weight(weights_of(buckets), buckets.count, 1.0f, n);
    }
    if (exploring) return {light, density(sp, buckets, bucket, light), n.u};
    const auto known = candidates(sp, buckets, bucket);
    if (known.count == 0) return {};
    const WeighedLights w(known, sp);
    const uint32_t i = w.choose(n);
    light = known.id_at(i);
    return {light, density(sp, buckets, bucket, w[i], light), n.u};
  }

  RELUME_HD float pmf(const SurfacePoint& sp, LightId light) const {
    if (!lists_infinite && light >= infinite.first) return infinite.pmf(light);
    if (nothing_emits()) return 0.0f;
    const LightBuckets buckets = buckets_of(sp);
    return density(sp, buckets, buckets.count > 0 ? light % buckets.count : 0, light);
  }

 private:
  /// Whether exploration has no light to choose.
  RELUME_HD bool nothing_emits() const { return all.empty() && !(lists_infinite && infinite.share > 0.0f); }

  /// Share of samples that explore in a region with a list.
  RELUME_HD float exploration_at(const SurfacePoint& sp) const {
    return learns_exploration && sp.region < shares.size ? shares[sp.region].exploration : exploration;
  }

  /// Chooses among all lights, or all finite ones if those at infinity are a separate group.
  RELUME_HD LightSelection explore(const Vec3& position, ReusableNumber n) const {
    if (lists_infinite && infinite.takes(n)) return infinite.sample(n);
    const DiscreteSample s = all.at(position).sample(n);
    return {s.index, s.pmf, s.u};
  }

  /// Probability of that choice.
  RELUME_HD float explored_pmf(const Vec3& position, LightId light) const {
    if (!lists_infinite) return all.at(position).pmf(light);
    if (light >= infinite.first) return infinite.pmf(light);
    return all.empty() ? 0.0f : (1.0f - infinite.share) * all.at(position).pmf(light);
  }

  RELUME_HD LightBuckets buckets_of(const SurfacePoint& sp) const {
    return sp.region < regions.size ? regions[sp.region] : LightBuckets{};
  }
  RELUME_HD const float* weights_of(const LightBuckets& b) const { return bucket_weights.data + b.first / bucket_size; }

  struct IdsOfBucket {
    const uint32_t* first;

    RELUME_HD LightId operator()(uint32_t i) const { return CachedLight::id(first[i]); }
  };

  /// The lights of a bucket.
  RELUME_HD ListedLights<IdsOfBucket> candidates(const SurfacePoint& sp, const LightBuckets& b, uint32_t bucket) const {
    const uint32_t* const entry = entries.data + b.first + bucket * bucket_size;
    uint32_t count = 0;
    while (count < bucket_size && entry[count] != CachedLight::kNone) ++count;
    return {{ltc, lights, compact, count, {entry}}, lists_infinite, shares, sp.region};
  }

  /// Probability of `light`, given its bucket. Weighs the bucket only if needed, because most explored lights are not
  /// in it.
  RELUME_HD_INLINE float density(const SurfacePoint& sp, const LightBuckets& buckets, uint32_t bucket,
                                 LightId light) const {
    WeighedLight w;
    if (buckets.count > 0) {
      const auto known = candidates(sp, buckets, bucket);
      uint32_t place = 0;
      while (place < known.count && known.id_at(place) != light) ++place;
      if (place < known.count) w = weigh_light(known, sp, place);
    }
    return density(sp, buckets, bucket, w, light);
  }

  /// The same for the weight of the light in its bucket (sum 0: the bucket lacks it): a one-sample mixture.
  RELUME_HD float density(const SurfacePoint& sp, const LightBuckets& buckets, uint32_t bucket, const WeighedLight& w,
                          LightId light) const {
    const float share = lists_infinite ? 1.0f : 1.0f - infinite.share;
    const float explored = explored_pmf(sp.position, light);
    if (buckets.count == 0) return share * explored;
    const float cached = w.sum > 0.0f ? w.weight / w.sum * weights_of(buckets)[bucket] : 0.0f;
    const float exploring = exploration_at(sp);
    return share * (exploring * explored + (1.0f - exploring) * cached);
  }
};

}  // namespace relume
