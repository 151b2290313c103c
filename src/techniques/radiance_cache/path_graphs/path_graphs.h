// Adaptive path graphs ([Schipek22 §4.2]): a path adds up the variance that its vertices bring into the pixel, as cells
// of earlier frames estimate it, and lets a cell take over where the sum would exceed a constant. Every vertex feeds
// its cell with its own direct light and what the cell of the next vertex reflects, so light creeps along the cells
// from frame to frame; but for those behind eight others whose samples wait for a cell that knows enough, as in the
// first frames of long paths, which are counted. Cells of different depths are separate; no cell can feed itself.
// Departures from the thesis' algorithm 2, which loses energy, are in README.md.
#pragma once

#include "techniques/radiance_cache/adaptive_psf/adaptive_psf.h"

namespace relume {

class PathGraph;

/// What the vertices of all paths share.
struct PathGraphContext {
  using Policy = PathGraph;

  FilterContext filter;
  AdaptivePsf primary;             ///< survival at the first vertex, and blend of its cell with the graph, if enabled
  float variance_constant = 0.1f;  ///< variance that a path may bring; in units of the measure
  VarianceMeasure measure = VarianceMeasure::relative;  ///< relative: to the square of what the first cell shows
  float feed = 0.25f;  ///< share of the paths that go on to feed cells when they no longer count for the pixel; more of
                       ///< them where samples would weigh more than kCellWeightMax
  uint16_t deep_coarsening = 1;  ///< levels by which cells beyond the first vertex are coarser

  RELUME_HD PathGraph policy(const SampleIndex& index, uint32_t x, uint32_t y) const;
};

/// What a path graph does at the vertices of one path. Between two vertices that have cells ("anchors"), the path's
/// throughput and radiance are relative to the demodulated first of them.
class PathGraph : public NoPolicy {
 public:
  PathGraph() = default;
  RELUME_HD PathGraph(const PathGraphContext& context, const SampleIndex& index, uint32_t x, uint32_t y)
      : context_(&context), index_(&index), x_(x), y_(y) {
    pixel_.blend = 0.0f;
  }

  RELUME_HD const FilteredPixel& pixel() const { return pixel_; }

  RELUME_HD bool arrived(SurfacePoint& sp, PathState& path) {
    if (path.bounce == 0) pixel_.seen = path.radiance;
    scatters_ = true;
    demodulation_ = {};
    if (path.dispersed) return true;  // as in FilterVertex
    demodulation_ = demodulate(sp.bsdf, sp.wo_local.z, context_->filter.narrow_alpha);
    if (!demodulation_.filtered) return true;
    const Vec2 jitter = filter_random_2d(*index_, x_, y_, path.bounce);
    const bool first = !pixel_.filtered;
    point_ = grid().keys.point(sp, jitter, static_cast<uint16_t>(path.bounce + 1u), demodulation_.glossy,
                               first ? uint16_t{0} : context_->deep_coarsening);
    address_ = grid().keys.address(point_);
    grid().prefetch_moments(address_);
    return true;
  }

  RELUME_HD bool goes_on(PathState& path) {
    const Demodulation& d = demodulation_;
    if (!d.filtered) return true;
    const bool first = !pixel_.filtered;
    const uint32_t slot = grid().find(address_);
    if (first && !begin(slot, path)) return false;
    if (!first) advance(path);
    at_first_ = first;
    before_ = now_;
    // Cells that nobody sees directly have no other to stand in for them: who reaches a cell that is rarely reached
    // would be given the light of places that many reach, and the light of the rare ones would be lost.
    const CellMoments cell = first ? grid().moments(point_, slot) : grid().own_moments(slot);
    if (first) limit_ = variance_limit(d.albedo, cell);
    if (!grid().undersampled(cell)) {
      close_samples(d.albedo * cell.mean);
      take_over(d.albedo, cell, path.bounce);
      if (now_.share <= 0.0f && !is_followed(d)) return false;
    }
    const bool wanted = now_.share > 0.0f || feeds_;
    // Whether there is room must not depend on how the path goes on: samples would be chosen by what they find.
    has_own_ = wanted && (closed_ || open_count_ < kMaxOpen);
    if (wanted && !has_own_) ++skipped_;
    if (has_own_) {
      own_ = {point_, slot, Rgb(0), Rgb(1), sample_weight(), !first};
      grid().prefetch_sums(address_);
    }
    at_anchor_ = true;
    albedo_ = d.albedo;
    divisor_ = d.divisor();
    path.throughput = 1.0f / divisor_;
    return true;
  }

  RELUME_HD void scattered(const SurfacePoint&, const BsdfSample&, PathState& path) {
    if (!at_anchor_) return;
    at_anchor_ = false;
    if (!path.delta) {
      if (closed_) insert_open();
      return;
    }
    // The cell holds nothing of delta lobes: its sample ends here, and the path goes on as if there were no cell.
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

  /// Gives the samples that are still open to their cells.
  RELUME_HD void finished(PathState& path) {
    if (!pixel_.filtered) {
      pixel_.unfiltered = path.radiance;
      if (!scatters_) pixel_.seen = path.radiance;
      return;
    }
    if (pixel_.culled) return;
    settle(path);
    insert_open();
    if (has_own_) insert(own_);
    if (skipped_ > 0) atomic_add(&grid().counters->skipped_vertices, uint64_t{skipped_});
    if (!now_.terminated) pixel_.termination = static_cast<uint16_t>(path.bounce + 1u);
    // What a delta lobe at the first anchor shows is no part of what its cell stands for.
    if (past_cell_) pixel_.unfiltered += contribution_ - beside_;
    const Rgb traced = past_cell_ ? beside_ : contribution_;
    pixel_.traced = is_finite(traced) ? traced : Rgb(0);
  }

 private:
  /// A sample for a cell. While the cell of the next anchor is unknown it waits for the rest of the path. Without
  /// initial values: a path has room for many and uses few.
  struct Sample {
    CellPoint point;
    uint32_t slot;  ///< of the cell, if it has one already
    Rgb value;
    Rgb transport;  ///< from radiance that leaves the current anchor to the sample
    float weight;
    bool deep;  ///< beyond the first anchor
  };
  static constexpr uint32_t kMaxOpen = 8;

  struct Progress {
    float share = 1;     ///< of what the path finds in the pixel: 1, then α, then 0
    float variance = 0;  ///< brought into the pixel so far
    bool terminated = false;
  };

  RELUME_HD const HashGridView& grid() const { return context_->filter.grid; }

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
    return context_->primary.decide(grid(), pixel_, filter_random(*index_, x_, y_, 1));
  }

  /// From the last anchor to the vertex that has been reached.
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
    // Roulette goes on comparing the whole throughput with that behind the first anchor.
    path.rr_reference /= max_component(step);
  }

  /// Shares out what the path has found since the last anchor.
  RELUME_HD void settle(PathState& path) {
    const Rgb found = path.radiance;
    path.radiance = Rgb(0);
    if (has_own_) own_.value += found;
    const Rgb leaving = albedo_ * found;
    contribution_ += now_.share * arriving_ * leaving;
    for (uint32_t i = 0; i < open_count_ && !closed_; ++i) open_[i].value += open_[i].transport * leaving;
  }

  /// The cell of this vertex, which reflects `leaving`, stands for the rest of all samples behind, but for what a delta
  /// lobe shows; and, if a cell has taken over with α > 0 at the last vertex, for the rest of that α (algorithm 2 drops
  /// it).
  RELUME_HD void close_samples(const Rgb& leaving) {
    for (uint32_t i = 0; i < open_count_; ++i) open_[i].value += open_[i].transport * leaving;
    closed_ = demodulation_.has_delta;
    if (!closed_) insert_open();
    if (!now_.terminated) return;
    contribution_ += now_.share * arriving_ * leaving;
    now_.share = 0.0f;
  }

  /// Eq. 4.14 and 4.15.
  RELUME_HD void take_over(const Rgb& albedo, const CellMoments& cell, uint32_t bounce) {
    if (now_.terminated) return;
    const Rgb throughput = arriving_ * albedo;
    const float local = sqr(luminance(throughput)) * cell.variance();
    if (now_.variance + local <= limit_) {
      now_.variance += local;
      return;
    }
    const float alpha = std::sqrt(relume::max(0.0f, limit_ - now_.variance) / local);
    contribution_ += (now_.share * (1.0f - alpha)) * throughput * cell.mean;
    now_ = {now_.share * alpha, limit_, true};
    pixel_.termination = static_cast<uint16_t>(bounce + 1u);
  }

  RELUME_HD float variance_limit(const Rgb& albedo, const CellMoments& cell) const {
    if (context_->measure == VarianceMeasure::absolute) return context_->variance_constant;
    if (grid().undersampled(cell)) return kInfinity;
    return context_->variance_constant * sqr(luminance(arriving_ * albedo * cell.mean));
  }

  /// Whether a path that no longer counts is followed: to feed cells, or because a delta lobe may lead past the cell.
  RELUME_HD bool is_followed(const Demodulation& d) {
    if (!decided_) feeds_ = filter_random(*index_, x_, y_, 2) < feed_share();
    decided_ = true;
    return feeds_ || d.has_delta;
  }

  /// Probability of that: as asked for, or what keeps the weight of samples within kCellWeightMax. 0: never.
  RELUME_HD float feed_share() const {
    const float least = context_->feed > 0.0f ? 1.0f / (kCellWeightMax * pixel_.survival) : 0.0f;
    return relume::max(context_->feed, least);
  }

  /// Inverse probability with which a sample at this vertex is taken.
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
  // Of the vertex that was reached last.
  Demodulation demodulation_;
  CellPoint point_;
  CellAddress address_;
  Rgb contribution_{0};
  Rgb beside_{0};    ///< of it, what was found before the path left the first anchor through a delta lobe
  Rgb arriving_{1};  ///< throughput from the camera to the last anchor, without its albedo
  Rgb albedo_{1};    ///< ρ of the last anchor
  Rgb divisor_{1};   ///< of the last anchor's radiance
  float limit_ = kInfinity;
  Progress now_;
  Progress before_;        ///< on arrival at the last anchor
  bool scatters_ = false;  ///< the path has met a surface that takes it on
  bool at_anchor_ = false;
  bool at_first_ = false;   ///< the last anchor is the first one
  bool past_cell_ = false;  ///< the path has left that one through a delta lobe
  bool closed_ = false;     ///< open samples wait for what a delta lobe of the last anchor shows, for nothing else
  bool has_own_ = false;
  bool feeds_ = false;
  bool decided_ = false;
  uint32_t open_count_ = 0;
  uint32_t skipped_ = 0;  ///< vertices without room for their sample
  Sample own_;
  Sample open_[kMaxOpen];
};

RELUME_HD inline PathGraph PathGraphContext::policy(const SampleIndex& index, uint32_t x, uint32_t y) const {
  return {*this, index, x, y};
}

/// Traces one path a pixel, lets cells take over, and feeds them.
using PathGraphKernel = CellPathsKernel<PathGraphContext>;

}  // namespace relume
