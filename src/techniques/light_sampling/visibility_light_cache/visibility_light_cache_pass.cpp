#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache_pass.h"

#include <algorithm>
#include <utility>

#include "techniques/light_sampling/light_selection/compact_lights.h"
#include "techniques/light_sampling/visibility_light_cache/exploration.h"
#include "techniques/light_sampling/visibility_light_cache/known_lights.h"

namespace relume {

bool VisibilityLightCachePass::run(const FrameContext& frame) {
  update_lights(frame);
  if (loaded_) drop_inconsistent(frame);
  snapshot_.begin_frame(frame.backend, frame.begins_epoch, caches_);
  if (generation_ != octree_.generation()) {
    build_caches(frame);
  } else if (selector_.cache.bucket_size != static_cast<uint32_t>(settings_.bucket_size) ||
             selector_.cache.lists_infinite != settings_.lists_infinite()) {
    caches_.clear();
  }
  const LightsView& lights = frame.scene.lights;
  all_.build(frame.backend, finite_summaries(lights), lights.bounds.radius, frame.scene.camera.position,
             {settings_.energy_weight, settings_.change_weight, settings_.distance_weight},
             static_cast<uint32_t>(settings_.exploration_cells));
  set_selector(lights);
  return true;
}

void VisibilityLightCachePass::update_lights(const FrameContext& frame) {
  const bool rebuilds = includes(frame.changes, kRebuildsLights);
  // Changed lights are unchanged again one frame later.
  if (!std::exchange(lights_changed_, rebuilds) && !rebuilds && built_) return;
  built_ = false;
  const LightsView& lights = frame.scene.lights;
  const uint32_t listed = listed_lights(lights);
  summaries_.reset(listed, kUninitialized);
  frame.launch("vlc.lights", LightSummariesKernel{lights, settings_.change_measure, summaries_.mutable_view()},
               {listed, 1});
  write_compact_lights(frame.backend, "vlc.lights", lights, listed, compact_);
  all_.update_digest(frame.backend, finite_summaries(lights));
  frame.backend.run("vlc.lights", [&] { infinite_.assign(build_infinite_lights(lights, selection_.infinity())); });
  built_ = true;
}

void VisibilityLightCachePass::build_caches(const FrameContext& frame) {
  if (!octree_.has_samples()) {
    caches_.clear();
    generation_ = octree_.generation();
    return;
  }
  CacheBuildOptions options;
  options.bucket_size = static_cast<uint32_t>(settings_.bucket_size);
  options.max_samples = static_cast<uint32_t>(settings_.max_samples);
  options.hysteresis = settings_.hysteresis;
  options.memory = static_cast<uint32_t>(settings_.memory);
  options.even_buckets = settings_.even_buckets;
  if (settings_.lists_infinite()) options.first_infinite = frame.scene.lights.first_infinite;
  options.exploration = {settings_.learn_exploration, settings_.exploration, settings_.exploration_floor};
  options.scene_radius = frame.scene.lights.bounds.radius;
  if (built_generation_ != octree_.generation())
    caches_.build(frame.backend, octree_.previous(), octree_.groups(), summaries_.view(), options, scratch_);
  built_generation_ = octree_.generation();
  caches_.populate(frame.backend, octree_.tree(), scratch_);
  generation_ = octree_.generation();
}

PassDeclaration KnownLightsPass::declaration() const {
  return {.name = "vlc-view",
          .stage = Stage::present,
          .owns = {{.id = kKnownLights,
                    .help = "number of lights cached for the region of the first hit",
                    .display = BufferDisplay::value}}};
}

bool KnownLightsPass::run(const FrameContext& frame) {
  const LightCaches& caches = cache_.caches();
  known_.reset(caches.buckets().size, kUninitialized);
  const CountKnownLightsKernel count{caches.buckets(), caches.entries(), cache_.selector().cache.bucket_size,
                                     known_.mutable_view()};
  frame.launch("vlc-view", count, {caches.buckets().size, 1});
  const KnownLightsKernel show{octree_.samples(), known_.view(), frame.write(kKnownLights), frame.width()};
  frame.launch("vlc-view", show);
  return true;
}

void VisibilityLightCachePass::set_selector(const LightsView& lights) {
  VisibilityLightCache& view = selector_.cache;
  const LightCaches& sampled = snapshot_.of(caches_);
  view.regions = sampled.buckets();
  view.entries = sampled.entries();
  view.bucket_weights = sampled.bucket_weights();
  view.bucket_size = static_cast<uint32_t>(settings_.bucket_size);
  view.exploration = settings_.exploration;
  view.learns_exploration = settings_.learn_exploration;
  view.lists_infinite = settings_.lists_infinite();
  view.shares = sampled.shares();
  view.all = all_.grid();
  view.infinite = make_infinite_lights(lights, infinite_.view(), !view.all.empty());
  view.ltc = ltc_table(ltc_);
  view.compact = compact_.view();
  view.lights = lights;
}

std::vector<PassStatistic> VisibilityLightCachePass::statistics() const {
  uint64_t regions = 0;
  uint64_t buckets = 0;
  uint64_t lights = 0;
  const std::span<const LightBuckets> all = caches_.read_buckets();
  for (uint32_t region = 0; region < all.size(); ++region) {
    const uint32_t count = all[region].count;
    if (count == 0) continue;
    ++regions;
    buckets += count;
    lights += caches_.list(region).size;
  }
  const double n = static_cast<double>(std::max<uint64_t>(regions, 1));
  return {{"regions", static_cast<double>(regions)},
          {"lights-a-region", static_cast<double>(lights) / n},
          {"buckets-a-region", static_cast<double>(buckets) / n},
          {"dropped", static_cast<double>(caches_.dropped())},
          {"cache-bytes", static_cast<double>(caches_.region_bytes())},
          {"entry-bytes", static_cast<double>(caches_.entry_bytes())}};
}

std::vector<PassRecords> VisibilityLightCachePass::records() const {
  struct Entry {
    uint32_t region = 0;
    uint32_t light = 0;
    uint32_t age = 0;
    uint32_t bucket = 0;
  };
  const auto read = [this] {
    std::vector<Entry> entries;
    const std::span<const LightBuckets> all = caches_.read_buckets();
    for (uint32_t region = 0; region < all.size(); ++region) {
      const uint32_t buckets = all[region].count;
      if (buckets == 0) continue;
      for (const uint32_t packed : caches_.list(region)) {
        const LightId light = CachedLight::id(packed);
        entries.push_back({region, light, CachedLight::age(packed), light % buckets});
      }
    }
    return entries;
  };
  return {pass_records<Entry>("lights",
                              "a light that a region lists: light number, frames since a sample saw it, and its bucket",
                              {record_field("region", &Entry::region), record_field("light", &Entry::light),
                               record_field("age", &Entry::age), record_field("bucket", &Entry::bucket)},
                              read)};
}

void VisibilityLightCachePass::save(std::ostream& out) const {
  caches_.save(out);
  snapshot_.save(out);
}

void VisibilityLightCachePass::load(std::istream& in) {
  caches_.load(in);
  snapshot_.load(in, LightCaches(summaries_.memory()));
  generation_ = octree_.generation();
  loaded_ = true;
}

void VisibilityLightCachePass::drop_inconsistent(const FrameContext& frame) {
  loaded_ = false;
  const auto bucket_size = static_cast<uint32_t>(settings_.bucket_size);
  selector_.cache.bucket_size = bucket_size;
  selector_.cache.lists_infinite = settings_.lists_infinite();
  bool consistent = false;
  frame.backend.run("vlc.lights", [&] {
    const auto is_consistent = [&](const LightCaches& caches) {
      return caches.consistent(bucket_size, listed_lights(frame.scene.lights));
    };
    consistent = is_consistent(caches_) && is_consistent(snapshot_.of(caches_));
  });
  if (consistent) return;
  caches_.clear();
  snapshot_.reset();
}

size_t VisibilityLightCachePass::memory_bytes() const {
  return caches_.memory_bytes() + snapshot_.memory_bytes() + all_.memory_bytes() + summaries_.memory_bytes() +
         infinite_.memory_bytes() + compact_.memory_bytes() + ltc_.memory_bytes() + scratch_.memory_bytes();
}

}  // namespace relume
