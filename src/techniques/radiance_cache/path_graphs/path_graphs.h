// Adaptive path graphs ([Schipek22 §4.2]). A path sums the variance that its vertices contribute to the pixel, as
// estimated by cells of earlier frames. Where the sum would exceed a constant, a cell replaces the rest of the path.
//
// Every vertex adds a sample to its cell: its direct light and the radiance that the next vertex's cell reflects. Light
// therefore propagates from cell to cell by one bounce per frame. Vertices behind eight waiting samples add none and
// are counted; this occurs on long paths in the first frames. Cells of different depths are separate, so no cell feeds
// itself. README.md lists the deviations from the thesis' algorithm 2, which loses energy.
#pragma once

#include "techniques/radiance_cache/adaptive_psf/adaptive_psf.h"

namespace relume {

class PathGraph;

/// Whether a path should pass a cell of this edge without reading it: the segment that leads there is shorter than the
/// cell, or the path's ray cone is narrower. The blur of the cell would then be visible. All in metres.
RELUME_HD inline bool guarded(float edge, float segment, float footprint) { return segment < edge || footprint < edge; }

/// Constants of all paths.
struct PathGraphContext {
  using Policy = PathGraph;
  static constexpr bool fills_samples = true;  ///< paths of reservoir samples read these cells (kFillsSamples)

  FilterContext filter;
  AdaptivePsf primary;             ///< survival at the first vertex, and blend of its cell with the graph, if enabled
  float variance_constant = 0.1f;  ///< maximum variance of a path, in units of `measure`
  VarianceMeasure measure = VarianceMeasure::relative;  ///< relative: the squared radiance that the first cell shows
  float feed = 0.25f;  ///< share of paths that continue to feed cells after their contribution ended; raised where
                       ///< weights would exceed kCellWeightMax
  uint16_t deep_coarsening = 1;  ///< levels by which cells beyond the first vertex are coarser
  bool guards = false;           ///< whether cells beyond the first vertex are read only where guarded() is false

  RELUME_HD PathGraph policy(const SampleIndex& index, uint32_t x, uint32_t y) const;
};

/// The policy of one path. Between two vertices with cells ("anchors"), the path's throughput and radiance are relative
/// to the demodulated first of them.
///
/// If reservoirs take the light from the second vertex on (FilterContext::indirect_apart), primary hits are no anchors.
/// The graph of that light begins at the vertex where it is found, and so do those of start_sample(). The light becomes
/// the radiance of the finished path, for the policy that takes it.
class PathGraph : public NoPolicy {
 public:
  static constexpr bool resamples_lights = true;

  PathGraph() = default;
  RELUME_HD PathGraph(const PathGraphContext& context, const SampleIndex& index, uint32_t x, uint32_t y)
      : context_(&context), index_(&index), x_(x), y_(y) {
    pixel_.blend = 0.0f;
  }

  RELUME_HD const FilteredPixel& pixel() const { return pixel_; }
  /// As FilterVertex::found().
  RELUME_HD Rgb found(const PathState&) const { return pixel_.traced / positive_or_one(pixel_.factor); }
  RELUME_HD float scatter_chance() const { return scatter_chance_; }

  /// Starts the sample of a reservoir at the next vertex, behind a vertex from which reservoirs shift paths. The path
  /// must have throughput 1 and no radiance there.
  RELUME_HD void start_sample() { sampled_ = begins_sample_ = taken_ = true; }

  RELUME_HD bool arrived(SurfacePoint& sp, PathState& path) {
    if (path.bounce == 0) pixel_.seen = path.radiance;
    scatters_ = true;
    demodulation_ = {};
    if (context_->filter.indirect_apart && path.bounce == 0) return true;
    if (context_->filter.whole_apart && !sampled_) return true;
    if (context_->guards) {
      segment_ += glm::length(sp.position - path.ray.origin);
      // The sample may be shown by other pixels, so its path has no ray cone until it scatters again.
      footprint_ = begins_sample_ ? kInfinity : sp.footprint;
      begins_sample_ = false;
    }
    if (path.dispersed) return true;  // as in FilterVertex
    demodulation_ = demodulate(sp.bsdf, sp.wo_local.z, context_->filter.narrow_alpha);
    if (!demodulation_.filtered) return true;
    const Vec2 jitter = filter_random_2d(*index_, x_, y_, path.bounce);
    const bool first = shows_first_cell();
    point_ = grid().keys.point(sp, jitter, static_cast<uint16_t>(path.bounce + 1u), demodulation_.glossy,
                               first ? uint16_t{0} : context_->deep_coarsening, demodulation_.roughness);
    address_ = grid().keys.address(point_);
    grid().prefetch_moments(address_);
    return true;
  }

  template <typename Earlier>
  RELUME_HD bool goes_on(PathState& path, Earlier& earlier) {
    const Demodulation& d = demodulation_;
    if (!d.filtered) return true;
    const bool first = !pixel_.filtered;
    const uint32_t slot = grid().find(address_);
    const Rgb found = path.radiance;
    const bool shows = shows_first_cell();
    const bool ends = first && !begin(slot, path);
    if (!first) advance(path);
    earlier.rebased(found, unit_ * arriving_ * d.albedo);
    if constexpr (kHasEarlier<Earlier>) {
      if (shows) report_decision(grid(), pixel_, {}, earlier);
    }
    // Beyond the first vertex no other cell replaces an undersampled one. Rarely reached cells would receive the light
    // of frequently reached ones, and their own would be lost.
    const CellMoments cell = shows ? grid().moments(point_, slot) : grid().own_moments(slot);
    if (first) limit_ = variance_limit(d.albedo, cell);
    if (path.bounce == 0) scatter_chance_ = chance_at_first(cell);
    if (ends) return false;
    at_first_ = first;
    before_ = now_;
    const bool passes = !shows && context_->guards && guarded(edge(), segment_, footprint_);
    segment_ = 0.0f;
    if (!passes && !grid().undersampled(cell)) {
      close_samples(d.albedo * cell.mean);
      take_over(d.albedo, cell, path.bounce);
      earlier.ended_in_cell(unit_ * arriving_ * d.albedo * cell.mean);
      if (now_.share <= 0.0f && !follows(d, earlier)) return false;
    }
    const bool wanted = now_.share > 0.0f || feeds_;
    // Whether a vertex takes a sample must not depend on the rest of the path, or the samples would be biased.
    has_own_ = wanted && (closed_ || open_count_ < kMaxOpen);
    if (wanted && !has_own_) ++skipped_;
    if (has_own_) {
      own_ = {point_, slot, Rgb(0), Rgb(1), sample_weight(), !shows};
      grid().prefetch_sums(address_);
    }
    at_anchor_ = true;
    albedo_ = d.albedo;
    divisor_ = d.divisor();
    path.throughput = 1.0f / divisor_;
    return true;
  }

  template <typename Earlier>
  RELUME_HD void scattered(const SurfacePoint&, const BsdfSample&, PathState& path, Earlier& earlier) {
    if (path.bounce == 1) sampled_ = begins_sample_ = context_->filter.indirect_apart && !path.delta;
    if (!at_anchor_) return;
    at_anchor_ = false;
    if (!path.delta) {
      if (closed_) insert_open();
      return;
    }
    // Cells exclude the light of delta lobes. The sample is complete, and the path continues as if without a cell.
    earlier.rebased(path.radiance, unit_ * arriving_);
    settle(path);
    closed_ = false;
    if (has_own_) insert(own_);
    has_own_ = false;
    now_ = before_;
    if (at_first_) {
      past_cell_ = true;
      beside_ = contribution_;
    }
    albedo_ = Rgb(1);
    path.throughput *= divisor_;
    path.rr_reference *= max_component(divisor_);
  }

  /// Starts the sample of a reservoir at the current vertex.
  RELUME_HD void rebased(const Rgb& found, const Rgb& unit) {
    kept_ = found;
    unit_ = unit;
    taken_ = true;
  }

  /// Adds all waiting samples to their cells.
  RELUME_HD void finished(PathState& path) {
    complete_pixel(path);
    if (!taken_) return;
    if (pixel_.filtered) path.radiance = pixel_.unfiltered + pixel_.traced;
    pixel_.filtered = false;
    pixel_.traced = Rgb(0);
    pixel_.unfiltered = kept_;
    if (!is_finite(path.radiance)) pixel_.unfiltered += path.radiance;  // AccumulateKernel counts it
  }

 private:
  RELUME_HD void complete_pixel(PathState& path) {
    if (!pixel_.filtered) {
      pixel_.unfiltered = path.radiance;
      if (!scatters_) pixel_.seen = path.radiance;
      return;
    }
    if (pixel_.culled) return;
    settle(path);
    insert_open();
    if (has_own_) insert(own_);
    if (skipped_ > 0) atomic_add(&grid().counters[0].skipped_vertices, uint64_t{skipped_});
    if (!now_.terminated) pixel_.termination = static_cast<uint16_t>(path.bounce + 1u);
    // The first anchor's cell excludes the light of its delta lobes.
    if (past_cell_) pixel_.unfiltered += contribution_ - beside_;
    const Rgb traced = past_cell_ ? beside_ : contribution_;
    pixel_.traced = is_finite(traced) ? traced : Rgb(0);
  }

  /// A sample for a cell. While the next anchor's cell is undersampled, it waits for the rest of the path. Has no
  /// initial values, because a path has space for many and uses few.
  struct Sample {
    CellPoint point;
    uint32_t slot;  ///< slot of the cell, or kNoCell
    Rgb value;
    Rgb transport;  ///< factor of radiance that leaves the current anchor
    float weight;
    bool deep;  ///< whether the vertex is beyond the first anchor
  };
  static constexpr uint32_t kMaxOpen = 8;

  struct Progress {
    float share = 1;     ///< share of sampled radiance that the pixel receives: 1, then α, then 0
    float variance = 0;  ///< variance of the pixel so far
    bool terminated = false;
  };

  RELUME_HD const HashGridView& grid() const { return context_->filter.grid; }
  /// Whether the current vertex is the first anchor, and the pixel may show its cell.
  RELUME_HD bool shows_first_cell() const { return !pixel_.filtered && !sampled_; }
  /// Edge of the cell of the current vertex.
  RELUME_HD float edge() const { return power_of_two(grid().keys.level_of(point_)); }

  RELUME_HD bool begin(uint32_t slot, PathState& path) {
    const Demodulation& d = demodulation_;
    pixel_.filtered = true;
    pixel_.divided = d.has_delta;
    pixel_.unfiltered = path.radiance;
    pixel_.factor = path.throughput * d.albedo;
    pixel_.point = point_;
    pixel_.slot = slot;
    arriving_ = path.throughput;
    path.radiance = Rgb(0);
    path.rr_reference = 1.0f;
    path.eta_scale = 1.0f;
    return sampled_ || context_->primary.decide(grid(), pixel_, filter_random(*index_, x_, y_, 1));
  }

  /// Advances from the last anchor to the current vertex.
  RELUME_HD void advance(PathState& path) {
    settle(path);
    const Rgb step = albedo_ * path.throughput;
    arriving_ *= step;
    for (uint32_t i = 0; i < open_count_; ++i) open_[i].transport *= step;
    if (has_own_) {
      own_.transport = path.throughput;
      open_[open_count_++] = own_;
    }
    has_own_ = false;
    // Russian roulette still compares the whole throughput with that after the first anchor.
    path.rr_reference /= max_component(step);
  }

  /// Distributes the radiance sampled since the last anchor to the pixel and the samples.
  RELUME_HD void settle(PathState& path) {
    const Rgb found = path.radiance;
    path.radiance = Rgb(0);
    if (has_own_) own_.value += found;
    const Rgb leaving = albedo_ * found;
    contribution_ += now_.share * arriving_ * leaving;
    for (uint32_t i = 0; i < open_count_ && !closed_; ++i) open_[i].value += open_[i].transport * leaving;
  }

  /// Completes all waiting samples with the radiance `leaving` that this vertex's cell reflects, except for light of
  /// its delta lobes. If an earlier cell left a share α > 0 to the path, this cell contributes it to the pixel
  /// (algorithm 2 drops it).
  RELUME_HD void close_samples(const Rgb& leaving) {
    for (uint32_t i = 0; i < open_count_; ++i) open_[i].value += open_[i].transport * leaving;
    closed_ = demodulation_.has_delta;
    if (!closed_) insert_open();
    if (!now_.terminated) return;
    contribution_ += now_.share * arriving_ * leaving;
    now_.share = 0.0f;
  }

  /// Applies the variance budget: eq. 4.14 and 4.15.
  RELUME_HD void take_over(const Rgb& albedo, const CellMoments& cell, uint32_t bounce) {
    if (now_.terminated) return;
    const Rgb throughput = arriving_ * albedo;
    const float local = sqr(luminance(throughput)) * cell.variance();
    if (now_.variance + local <= limit_) {
      now_.variance += local;
      return;
    }
    const float alpha = kept_share(local);
    contribution_ += (now_.share * (1.0f - alpha)) * throughput * cell.mean;
    now_ = {now_.share * alpha, limit_, true};
    pixel_.termination = static_cast<uint16_t>(bounce + 1u);
  }

  /// α of eq. 4.15: share of the sampled light that stays, where a cell of variance `local` exceeds the limit.
  RELUME_HD float kept_share(float local) const { return std::sqrt(relume::max(0.0f, limit_ - now_.variance) / local); }

  /// Probability with which a path samples a direction at its first vertex. It depends on the cell alone: a path that
  /// ends there has the same probability as one that continues.
  RELUME_HD float chance_at_first(const CellMoments& cell) const {
    const Demodulation& d = demodulation_;
    if (d.has_delta || grid().undersampled(cell)) return pixel_.survival;
    const float local = sqr(luminance(arriving_ * d.albedo)) * cell.variance();
    const bool only_feeds = !(local <= limit_) && kept_share(local) <= 0.0f;
    return only_feeds ? pixel_.survival * feed_share() : pixel_.survival;
  }

  RELUME_HD float variance_limit(const Rgb& albedo, const CellMoments& cell) const {
    if (context_->measure == VarianceMeasure::absolute) return context_->variance_constant;
    if (grid().undersampled(cell)) return kInfinity;
    return context_->variance_constant * sqr(luminance(arriving_ * albedo * cell.mean));
  }

  /// Whether a path continues after its contribution ended: to feed cells, or because a delta lobe bypasses the cell.
  RELUME_HD bool is_followed(const Demodulation& d) {
    if (!decided_) feeds_ = filter_random(*index_, x_, y_, 2) < feed_share();
    decided_ = true;
    return feeds_ || d.has_delta;
  }

  /// The same, reported to earlier policies. Where only feeding continues the path, it does so with that probability.
  template <typename Earlier>
  RELUME_HD bool follows(const Demodulation& d, Earlier& earlier) {
    if (!is_followed(d)) {
      earlier.culled();
      return false;
    }
    if (!d.has_delta) earlier.survived(pixel_.survival * feed_share());
    return true;
  }

  /// Probability of feeding: `feed`, raised where weights would exceed kCellWeightMax; 0: never.
  RELUME_HD float feed_share() const {
    const float least = context_->feed > 0.0f ? 1.0f / (kCellWeightMax * pixel_.survival) : 0.0f;
    return relume::max(context_->feed, least);
  }

  /// Inverse probability of a sample at this vertex.
  RELUME_HD float sample_weight() const { return (now_.share > 0.0f ? 1.0f : 1.0f / feed_share()) / pixel_.survival; }

  RELUME_HD void insert(const Sample& sample) const {
    grid().insert(sample.point, sample.value, sample.weight, filter_random(*index_, x_, y_, 2u + sample.point.layer),
                  sample.slot, sample.deep);
  }

  RELUME_HD void insert_open() {
    for (uint32_t i = 0; i < open_count_; ++i) insert(open_[i]);
    open_count_ = 0;
    closed_ = false;
  }

  const PathGraphContext* context_ = nullptr;
  const SampleIndex* index_ = nullptr;
  uint32_t x_ = 0;
  uint32_t y_ = 0;
  FilteredPixel pixel_;
  // State of the current vertex.
  Demodulation demodulation_;
  CellPoint point_;
  CellAddress address_;
  float segment_ = 0;    ///< length of the path since the last anchor, metres
  float footprint_ = 0;  ///< width of the path's ray cone
  Rgb contribution_{0};
  Rgb beside_{0};    ///< part of it sampled before the path left the first anchor through a delta lobe
  Rgb arriving_{1};  ///< throughput from the camera, or from where reservoirs take the light, to the last anchor,
                     ///< without its albedo
  Rgb unit_{1};      ///< factor from `arriving_` to the throughput from the camera
  Rgb kept_{0};      ///< radiance of the path up to where reservoirs take the light
  Rgb albedo_{1};    ///< ρ of the last anchor
  Rgb divisor_{1};   ///< divisor of the last anchor's radiance
  float limit_ = kInfinity;
  float scatter_chance_ = 1;
  Progress now_;
  Progress before_;             ///< progress on arrival at the last anchor
  bool scatters_ = false;       ///< whether the path has hit a surface
  bool sampled_ = false;        ///< whether reservoirs take light from the path, if it hits a surface
  bool begins_sample_ = false;  ///< whether they take it from the next vertex on
  bool taken_ = false;          ///< whether they take it from the current or an earlier vertex on
  bool at_anchor_ = false;
  bool at_first_ = false;   ///< whether the last anchor is the first one
  bool past_cell_ = false;  ///< whether the path left the first anchor through a delta lobe
  bool closed_ = false;     ///< whether waiting samples lack only the light of delta lobes of the last anchor
  bool has_own_ = false;
  bool feeds_ = false;
  bool decided_ = false;
  uint32_t open_count_ = 0;
  uint32_t skipped_ = 0;  ///< vertices behind too many waiting samples
  Sample own_;
  Sample open_[kMaxOpen];
};

RELUME_HD inline PathGraph PathGraphContext::policy(const SampleIndex& index, uint32_t x, uint32_t y) const {
  return {*this, index, x, y};
}

/// Traces one path graph per pixel and fills the cells.
using PathGraphKernel = CellPathsKernel<PathGraphContext>;

}  // namespace relume
