// The pass for the light selection "vlc", after the octree pass.
#pragma once

#include "frame/pass.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/light_sampling/light_selection/settings.h"
#include "techniques/light_sampling/visibility_light_cache/build_cache.h"
#include "techniques/light_sampling/visibility_light_cache/exploration.h"
#include "techniques/light_sampling/visibility_light_cache/settings.h"
#include "techniques/spatial/octree/octree_pass.h"
#include "techniques/spatial/octree/snapshot.h"

namespace relume {

class VisibilityLightCachePass final : public Pass {
 public:
  VisibilityLightCachePass(const VisibilityLightCacheSettings& settings, const LightSelectionSettings& selection,
                           const OctreePass& octree, Memory& memory)
      : settings_(settings),
        selection_(selection),
        octree_(octree),
        caches_(memory),
        scratch_(memory),
        summaries_(memory),
        all_(memory),
        infinite_(memory),
        compact_(memory),
        ltc_(memory) {
    selector_.kind = LightSelectorKind::cache;
  }

  void configure(const VisibilityLightCacheSettings& settings) {
    // Buckets of another size, or of other lights, cannot be completed. Otherwise, samples must not be included twice.
    if (settings.bucket_size != settings_.bucket_size || settings.infinite != settings_.infinite) built_generation_ = 0;
    settings_ = settings;
  }
  void configure(const LightSelectionSettings& selection) { selection_ = selection; }
  PassDeclaration declaration() const override { return {.name = "vlc", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override;
  std::vector<PassStatistic> statistics() const override;
  std::vector<PassRecords> records() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// Valid after the first run().
  const LightSelector& selector() const { return selector_; }
  /// The caches of the regions of octree.tree().
  const LightCaches& caches() const { return caches_; }

 private:
  /// Recomputes summaries, compact forms and lights at infinity if lights have changed.
  void update_lights(const FrameContext& frame);
  /// Clears the caches that a damaged checkpoint left inconsistent.
  void drop_inconsistent(const FrameContext& frame);
  void build_caches(const FrameContext& frame);
  void set_selector(const LightsView& lights);
  /// Number of lights that regions may list.
  uint32_t listed_lights(const LightsView& lights) const {
    return settings_.lists_infinite() ? lights.lights.size : lights.first_infinite;
  }
  View<const LightSummary> finite_summaries(const LightsView& lights) const {
    return {summaries_.view().data, lights.first_infinite};
  }

  VisibilityLightCacheSettings settings_;
  LightSelectionSettings selection_;
  const OctreePass& octree_;
  LightSelector selector_;
  LightCaches caches_;
  CacheScratch scratch_;
  Snapshot<LightCaches> snapshot_;
  uint64_t built_generation_ = 0;  ///< generation of the octree whose samples the caches include; 0: none
  uint64_t generation_ = 0;        ///< generation of the octree whose regions have the caches
  bool loaded_ = false;            ///< whether a loaded checkpoint is still unchecked
  bool built_ = false;             ///< whether the data of lights is complete
  bool lights_changed_ = false;    ///< whether lights have changed since the frame before
  Array<LightSummary> summaries_;
  ExplorationTables all_;
  Array<AliasEntry> infinite_;
  Array<CompactLight> compact_;
  Array<LtcMatrix> ltc_;
};

inline constexpr BufferKey<uint32_t> kKnownLights{"known-lights"};

class KnownLightsPass final : public Pass {
 public:
  KnownLightsPass(const OctreePass& octree, const VisibilityLightCachePass& cache, Memory& memory)
      : octree_(octree), cache_(cache), known_(memory) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override { return known_.memory_bytes(); }

 private:
  const OctreePass& octree_;
  const VisibilityLightCachePass& cache_;
  Array<uint32_t> known_;  ///< number of lights by leaf slot
};

}  // namespace relume
