// Adaptive path space filtering at primary surfaces ([Schipek22 §4.1]): the variance of a pixel's cell in earlier
// frames decides with which probability a path is followed, and how cell and path are mixed.
#pragma once

#include "techniques/adaptive_psf/variance_functions.h"
#include "techniques/path_space_filter/path_space_filter.h"

namespace relume {

struct AdaptivePsf {
  SurvivalFunction survival_function = SurvivalFunction::smooth_linear;
  BlendFunction blend_function = BlendFunction::one;
  VarianceMeasure measure = VarianceMeasure::relative;
  VarianceThresholds survival_thresholds;
  VarianceThresholds blend_thresholds;
  float survival_floor = 0.1f;  ///< no cell starves
  float min_count = 128;        ///< samples below which a cell's variance is not believed
  bool enabled = true;

  /// The variance that thresholds are compared with. Infinite for what is too thin to have one.
  RELUME_HD float variance(const HashGridView& grid, const CellMoments& cell) const {
    if (cell.count < relume::max(min_count, grid.min_count)) return kInfinity;
    const float v = cell.variance();
    if (measure == VarianceMeasure::absolute) return v;
    const float mean = luminance(cell.mean);
    return mean > 0.0f ? v / sqr(mean) : 0.0f;
  }

  /// Decides about the path of a pixel whose filter vertex has just been reached: fills slot, survival, blend, culled.
  /// False if the path is not to be followed; the pixel then shows its cell, whatever the blend would have asked for,
  /// since there is no path to blend with. Paths that a delta lobe may need always survive. `u` in [0, 1).
  RELUME_HD bool decide(const HashGridView& grid, FilteredPixel& pixel, float u) const {
    if (!enabled) return true;
    if (pixel.slot == kNoCell) pixel.slot = grid.find(grid.keys.address(pixel.point));
    // The cell's own moments: whoever shares the key must come to the same probability.
    const CellMoments cell = grid.own_moments(pixel.slot);
    const float v = variance(grid, cell);
    const bool known = v < kInfinity;
    pixel.survival = known && !pixel.divided
                         ? relume::max(survival(survival_function, survival_thresholds, v), survival_floor)
                         : 1.0f;
    pixel.blend = blend(blend_function, blend_thresholds, v);
    pixel.culled = u >= pixel.survival;
    if (pixel.culled) pixel.blend = 1.0f;
    return !pixel.culled;
  }
};

/// A filter vertex that may end its path.
class AdaptiveVertex : public NoObserver {
 public:
  AdaptiveVertex() = default;
  RELUME_HD AdaptiveVertex(const AdaptivePsf& adaptive, const FilterContext& context, const Vec2& u, float u_survival)
      : adaptive_(&adaptive), grid_(&context.grid), vertex_(context, u), u_survival_(u_survival) {}

  RELUME_HD FilterVertex& vertex() { return vertex_; }

  RELUME_HD bool arrived(SurfacePoint& sp, PathState& path) {
    const bool before = vertex_.reached();
    vertex_.arrived(sp, path);
    return before || !vertex_.reached() || adaptive_->decide(*grid_, vertex_.pixel(), u_survival_);
  }
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, PathState& path) {
    vertex_.scattered(sp, s, path);
  }

 private:
  const AdaptivePsf* adaptive_ = nullptr;
  const HashGridView* grid_ = nullptr;
  FilterVertex vertex_;
  float u_survival_ = 0;
};

/// Traces the paths that survive and fills the cells.
struct AdaptivePsfKernel {
  PathContext context;
  FilterContext filter;
  AdaptivePsf adaptive;
  SampleIndex index;
  View<const Hit> hits;
  View<const uint32_t> allocation;  ///< paths the pixel gets, 0 or 1; empty: 1
  View<FilteredPixel> pixels;
  View<uint32_t> rays;  ///< of this sample
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const { trace_pixel(*this, x, y); }
  void operator()(const Tile& tile) const { path_batch::trace_tile(*this, tile); }

  RELUME_HD bool wanted(uint32_t pixel) const { return allocation.empty() || allocation[pixel] != 0; }
  RELUME_HD void leave_out(uint32_t pixel) const {
    pixels[pixel] = {};
    rays[pixel] = 0;
  }
  RELUME_HD AdaptiveVertex observer(uint32_t x, uint32_t y) const {
    return {adaptive, filter, filter_random_2d(index, x, y, 0), filter_random(index, x, y, 1)};
  }
  RELUME_HD void finish(uint32_t pixel, AdaptiveVertex& observer, const PathState& path) const {
    observer.vertex().finish(path, filter_random(index, pixel % width, pixel / width, 0));
    pixels[pixel] = observer.vertex().pixel();
    rays[pixel] = path.rays;
  }
};

}  // namespace relume
