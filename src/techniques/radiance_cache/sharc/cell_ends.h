// Camera paths that end in cells of the spatially hashed radiance cache [Sharc25].
#pragma once

#include "techniques/radiance_cache/sharc/sharc_cells.h"
#include "techniques/transport/path/chain_output.h"
#include "techniques/transport/path/first_scatter.h"
#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/indirect_sample.h"
#include "techniques/transport/path/optional_output.h"
#include "techniques/transport/path/path_kernel.h"
#include "techniques/transport/path/recording_output.h"

namespace relume {

/// Half the width of a lobe's cone per metre, for its α: √(½ α² / (1 − α²)) [Sharc25], at most 1,000.
RELUME_HD inline float lobe_spread(float alpha) {
  constexpr float kWidest = 1000;
  const float a2 = sqr(alpha);
  return a2 < 1.0f ? relume::min(std::sqrt(0.5f * a2 / (1.0f - a2)), kWidest) : kWidest;
}

/// Whether the blur of a cell of this edge is invisible: the segment that leads there is at least as long, and the cone
/// of the path at least as wide. All in metres.
RELUME_HD inline bool hides(float segment, float cone, float edge) { return segment >= edge && cone >= edge; }

class CellEnd;

/// Output of the bounce at which each path ends, and constants of the policy that ends it.
struct CellEnds {
  using Policy = CellEnd;

  SharcCells cells;
  bool by_variance = false;  ///< whether the variance of a cell must be small, too
  float variance = 1;        ///< maximum variance of a sample, in units of the squared mean
  View<float> termination;   ///< bounce, from 1, per pixel; 0: no path

  /// Whether a path may end in a cell. Few samples do not show the variance. A black cell may have missed bright ones.
  RELUME_HD bool accepts(const CellMoments& cell) const {
    constexpr float kEnoughForVariance = 16;
    if (cells.grid.undersampled(cell)) return false;
    if (!by_variance) return true;
    const float mean = luminance(cell.mean);
    return cell.count >= kEnoughForVariance && mean > 0.0f && cell.variance() <= variance * sqr(mean);
  }

  RELUME_HD CellEnd policy(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t pixel) const;
  RELUME_HD void finish(uint32_t pixel, const CellEnd&, const PathState& path) const {
    termination[pixel] = static_cast<float>(path.bounce + 1u);
  }
  RELUME_HD void leave_out(uint32_t pixel) const { termination[pixel] = 0.0f; }
};

/// The policy of one camera path. The radiance of the cell replaces the rest of the path. Until a rough lobe has
/// scattered the path, its cone has no width.
class CellEnd : public NoPolicy {
 public:
  CellEnd() = default;
  RELUME_HD CellEnd(const CellEnds& ends, const SampleIndex& index, uint32_t x, uint32_t y)
      : ends_(&ends), index_(&index), x_(x), y_(y) {}

  /// Starts distances and the cone at the origin of the path's next segment, a vertex whose narrowest lobe has `alpha`.
  RELUME_HD void start_cone(float alpha) { spread_ = lobe_spread(alpha); }

  RELUME_HD bool arrived(const SurfacePoint& sp, const PathState& path) {
    has_cell_ = false;
    const float distance = glm::length(sp.position - path.ray.origin);
    segment_ += distance;
    cone_ += 2.0f * spread_ * distance;
    if (!(spread_ > 0.0f) || !SharcCells::may_hold(sp, path)) return true;
    const CellPoint point = ends_->cells.point(sp, filter_random_2d(*index_, x_, y_, path.bounce));
    if (!hides(segment_, cone_, power_of_two(grid().keys.level_of(point)))) return true;
    const Demodulation d = demodulation_of(sp.bsdf, sp.wo_local.z, ends_->cells.narrow_alpha);
    if (!d.filtered) return true;
    has_cell_ = true;
    address_ = grid().keys.address(point);
    grid().prefetch_moments(address_);
    albedo_ = d.albedo;
    return true;
  }

  /// The path itself receives the mean of the cell, so recorders need no ended_in_cell(): the mean is part of the light
  /// that earlier vertices record. The current vertex samples nothing, and must not train.
  template <typename Earlier>
  RELUME_HD bool goes_on(PathState& path, Earlier& earlier) const {
    if (!has_cell_) return true;
    const CellMoments cell = grid().own_moments(grid().find(address_));
    if (!ends_->accepts(cell)) return true;
    path.radiance += path.throughput * albedo_ * cell.mean;
    earlier.culled();
    return false;
  }

  /// The sample of a guided vertex names no lobe: any of them may reflect the direction.
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, const PathState&) {
    if (s.delta) return;
    const bool guided = s.bsdf_pdf_w > 0.0f;
    spread_ = relume::max(spread_, lobe_spread(guided ? narrowest_alpha(sp.bsdf) : s.alpha));
    segment_ = 0;
  }

 private:
  RELUME_HD const HashGridView& grid() const { return ends_->cells.grid; }

  const CellEnds* ends_ = nullptr;
  const SampleIndex* index_ = nullptr;
  uint32_t x_ = 0;
  uint32_t y_ = 0;
  CellAddress address_;
  Rgb albedo_{0};
  bool has_cell_ = false;  ///< whether the path may end in a cell of the current vertex
  float segment_ = 0;      ///< length of the path since a rough lobe scattered it, metres
  float cone_ = 0;         ///< width of the path's cone, metres
  float spread_ = 0;       ///< half its growth per metre
};

RELUME_HD inline CellEnd CellEnds::policy(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t /*pixel*/) const {
  return {*this, index, x, y};
}

/// Traces the camera paths.
using CellEndsKernel = PathKernel<RadianceOutput, CellEnds>;

/// Traces the camera paths and records first vertices. Cells are behind them, so their light is part of that along the
/// recorded directions.
using RecordedCellEndsKernel = PathKernel<RadianceOutput, FirstVertexOutput, CellEnds>;

/// These two kernels with records of first scattering events, for reservoirs that add the direct light of primary hits.
/// No cell holds light of primary hits.
using ReservoirCellEndsKernel = PathKernel<RadianceOutput, FirstScatterOutput, CellEnds>;
using RecordedReservoirCellEndsKernel = PathKernel<RadianceOutput, FirstScatterOutput, FirstVertexOutput, CellEnds>;

/// Traces the camera paths and records samples for regions and states for chains, beside the records of the other four.
using LearningCellEndsKernel =
    PathKernel<CachedRecordingOutput, CachedChainOutput, RadianceOutput, OptionalOutput<FirstScatterOutput>,
               OptionalOutput<FirstVertexOutput>, CellEnds>;

/// All four for reservoirs of indirect light: the samples that they take from paths end in cells.
using IndirectCellEndsKernel = PathKernel<RadianceOutput, OptionalOutput<FirstScatterOutput>, IndirectSampleOutput,
                                          OptionalOutput<FirstVertexOutput>, CellEnds>;

/// The same for paths from which regions or chains learn.
using LearningIndirectCellEndsKernel =
    PathKernel<CachedRecordingOutput, CachedChainOutput, RadianceOutput, OptionalOutput<FirstScatterOutput>,
               IndirectSampleOutput, OptionalOutput<FirstVertexOutput>, CellEnds>;

}  // namespace relume
