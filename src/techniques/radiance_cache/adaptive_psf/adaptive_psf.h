// Adaptive path space filtering at primary surfaces ([Schipek22 §4.1]). The variance of a pixel's cell in earlier
// frames determines the probability of following its path and the blend of cell and path.
#pragma once

#include "techniques/radiance_cache/adaptive_psf/variance_functions.h"
#include "techniques/radiance_cache/path_space_filter/path_space_filter.h"

namespace relume {

struct AdaptivePsf {
  SurvivalFunction survival_function = SurvivalFunction::smooth_linear;
  BlendFunction blend_function = BlendFunction::one;
  VarianceMeasure measure = VarianceMeasure::relative;
  SurvivalMeasure survival_measure = SurvivalMeasure::variance;
  VarianceThresholds survival_thresholds;  ///< in units of `survival_measure`
  VarianceThresholds blend_thresholds;
  float survival_floor = 0.1f;  ///< minimum probability, so that each cell receives samples
  float min_count = 128;        ///< samples below which a cell's variance counts as infinite
  bool enabled = true;

  /// The variance to compare with thresholds, in units of `measure`; infinite for undersampled cells.
  RELUME_HD float variance(const HashGridView& grid, const CellMoments& cell) const {
    if (cell.count < relume::max(min_count, grid.rule.min_count)) return kInfinity;
    const float v = cell.variance();
    if (measure == VarianceMeasure::absolute) return v;
    const float mean = luminance(cell.mean);
    return mean > 0.0f ? v / sqr(mean) : 0.0f;
  }

  /// Probability of following the paths of the cell in `slot`, whose variance() is `v`.
  RELUME_HD float survival_in(const HashGridView& grid, uint32_t slot, const CellMoments& cell, float v) const {
    if (!(v < kInfinity)) return 1.0f;
    if (survival_measure == SurvivalMeasure::standard_error) {
      // Black samples do not show that a cell is dark: bright ones may be rare.
      if (grid.histories[slot].changed != 0 || !(luminance(cell.mean) > 0.0f)) return 1.0f;
      v /= cell.count;
    }
    return relume::max(survival(survival_function, survival_thresholds, v), survival_floor);
  }

  /// Decides at the filter vertex whether the path is followed. Sets slot, survival, blend and culled. A culled pixel
  /// shows its cell with any blend function, because it has no sample. Paths at vertices with delta lobes always
  /// survive. `u` in [0, 1). `others`: the other cells of a split pixel; else not read. `needed`: whether the path
  /// survives in any case.
  RELUME_HD bool decide(const HashGridView& grid, FilteredPixel& pixel, float u, const View<OtherCells>& others = {},
                        bool needed = false) const {
    if (!enabled) return true;
    if (pixel.slot == kNoCell) pixel.slot = grid.find(grid.keys.address(pixel.point));
    // The cell's own moments: all pixels with the same key should have the same probability, or their samples differ in
    // weight.
    const CellMoments cell = grid.own_moments(pixel.slot);
    float v = variance(grid, cell);
    pixel.survival = pixel.divided || needed ? 1.0f : survival_in(grid, pixel.slot, cell, v);
    if (pixel.split) consider_specular(grid, pixel, others[0], v);
    pixel.blend = blend(blend_function, blend_thresholds, v);
    pixel.culled = u >= pixel.survival;
    if (pixel.culled) pixel.blend = 1.0f;
    return !pixel.culled;
  }

 private:
  /// Raises survival and the variance `v` to those of the specular cell. Sets its slot.
  RELUME_HD void consider_specular(const HashGridView& grid, FilteredPixel& pixel, OtherCells& others, float& v) const {
    others.specular_slot = grid.find(grid.keys.address(others.specular_point(pixel.point)));
    const CellMoments cell = grid.own_moments(others.specular_slot);
    const float specular = variance(grid, cell);
    pixel.survival = relume::max(pixel.survival, survival_in(grid, others.specular_slot, cell, specular));
    v = relume::max(v, specular);
  }
};

/// Reports the decision about a path at its filter vertex. The radiance of the path must be rebased. `others`: as for
/// AdaptivePsf::decide().
template <typename Earlier>
RELUME_HD inline void report_decision(const HashGridView& grid, const FilteredPixel& pixel,
                                      const View<OtherCells>& others, Earlier& earlier) {
  if (!pixel.culled) {
    if (pixel.survival < 1.0f) earlier.survived(pixel.survival);
    return;
  }
  Rgb shown = pixel.factor * grid.own_moments(pixel.slot).mean;
  if (pixel.split) shown += others[0].specular_factor * grid.own_moments(others[0].specular_slot).mean;
  earlier.ended_in_cell(shown);
  earlier.culled();
}

class AdaptiveVertex;

/// Path space filtering with survival and blend.
struct AdaptiveFilterContext {
  using Policy = AdaptiveVertex;

  FilterContext filter;
  AdaptivePsf adaptive;

  RELUME_HD AdaptiveVertex policy(const SampleIndex& index, uint32_t x, uint32_t y) const;
};

/// A filter vertex that may end its path.
class AdaptiveVertex : public NoPolicy {
 public:
  static constexpr bool resamples_lights = true;

  AdaptiveVertex() = default;
  RELUME_HD AdaptiveVertex(const AdaptiveFilterContext& context, const SampleIndex& index, uint32_t x, uint32_t y)
      : context_(&context), vertex_(context.filter, index, x, y), u_survival_(filter_random(index, x, y, 1)) {}

  RELUME_HD const FilteredPixel& pixel() { return vertex_.pixel(); }
  RELUME_HD Rgb found(const PathState& path) const { return vertex_.found(path); }
  RELUME_HD float scatter_chance() const { return scatter_chance_; }

  template <typename Earlier>
  RELUME_HD bool arrived(SurfacePoint& sp, PathState& path, Earlier& earlier) {
    const bool before = vertex_.reached();
    vertex_.arrived(sp, path, earlier);
    if (before || !vertex_.reached()) return true;
    FilteredPixel& pixel = vertex_.pixel();
    View<OtherCells> others;
    if (pixel.split) others = view_of_one(vertex_.others());
    const HashGridView& grid = context_->filter.grid;
    // The variance of a cell without reservoir light does not show whether reservoirs need the path.
    const bool needed = context_->filter.indirect_apart && path.bounce == 0;
    const bool follows = context_->adaptive.decide(grid, pixel, u_survival_, others, needed);
    if (path.bounce == 0) scatter_chance_ = pixel.survival;
    if constexpr (kHasEarlier<Earlier>) report_decision(grid, pixel, others, earlier);
    return follows;
  }
  RELUME_HD void connected(const SurfacePoint& sp, const PathState& path, const Connection& c, bool visible) {
    vertex_.connected(sp, path, c, visible);
  }
  template <typename Earlier>
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, PathState& path, Earlier& earlier) {
    vertex_.scattered(sp, s, path, earlier);
  }
  RELUME_HD void finished(const PathState& path) { vertex_.finished(path); }

 private:
  const AdaptiveFilterContext* context_ = nullptr;
  FilterVertex vertex_;
  float u_survival_ = 0;
  float scatter_chance_ = 1;
};

RELUME_HD inline AdaptiveVertex AdaptiveFilterContext::policy(const SampleIndex& index, uint32_t x, uint32_t y) const {
  return {*this, index, x, y};
}

/// Traces the paths that survive and fills the cells.
using AdaptivePsfKernel = CellPathsKernel<AdaptiveFilterContext>;

}  // namespace relume
