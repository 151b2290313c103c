// Every header that kernels include, and every pass kernel, compiled for the device.
#include "core/fixed_point.h"
#include "core/frame.h"
#include "core/hash.h"
#include "core/hd.h"
#include "core/lanes.h"
#include "core/octahedral.h"
#include "core/ray.h"
#include "core/vec.h"
#include "core/view.h"
#include "framebuffer/tone_map.h"
#include "relume/error.h"
#include "techniques/denoise/bmfr/bmfr.h"
#include "techniques/denoise/bmfr/regression_kernel.h"
#include "techniques/denoise/firefly_clamp/firefly_clamp.h"
#include "techniques/denoise/oidn/oidn.h"
#include "techniques/denoise/shared/edge_emission.h"
#include "techniques/denoise/shared/light_change.h"
#include "techniques/denoise/shared/picture_history.h"
#include "techniques/denoise/shared/split_light.h"
#include "techniques/denoise/svgf/svgf.h"
#include "techniques/gbuffer/features/features.h"
#include "techniques/gbuffer/primary_hits/primary_hits.h"
#include "techniques/guiding/direction_view/incident_light.h"
#include "techniques/guiding/directional_quadtree/adapt_quadtrees.h"
#include "techniques/light_sampling/static_light_lists/build_lists.h"
#include "techniques/light_sampling/visibility_light_cache/build_cache.h"
#include "techniques/light_sampling/visibility_light_cache/known_lights.h"
#include "techniques/radiance_cache/adaptive_psf/adaptive_psf.h"
#include "techniques/radiance_cache/path_graphs/path_graphs.h"
#include "techniques/radiance_cache/path_space_filter/path_space_filter.h"
#include "techniques/spatial/hash_grid/maintain.h"
#include "techniques/spatial/octree/octree_tree.h"
#include "techniques/spatial/octree/region_view.h"
#include "techniques/temporal/accumulate/accumulate.h"
#include "techniques/temporal/adaptive_sampling/paper_allocation.h"
#include "techniques/temporal/adaptive_sampling/pooled_deviation.h"
#include "techniques/temporal/reprojection/backward.h"
#include "techniques/temporal/reprojection/look_back.h"
#include "techniques/temporal/reprojection/reprojection.h"
#include "techniques/temporal/reprojection/specular_history.h"
#include "techniques/transport/bdpt/bdpt.h"
#include "techniques/transport/bdpt/light_medium.h"
#include "techniques/transport/path/path_kernel.h"
#include "techniques/transport/path/recording_output.h"
#include "techniques/transport/path/specular_part.h"

namespace relume {
namespace {

/// A pass kernel as the backend starts it on a device: one call of its operator per element.
template <typename Kernel>
__global__ void run(Kernel kernel, uint32_t width, uint32_t height) {
  const uint32_t x = blockIdx.x * blockDim.x + threadIdx.x;
  const uint32_t y = blockIdx.y * blockDim.y + threadIdx.y;
  if (x < width && y < height) kernel(x, y);
}

/// Calls what src/core offers to kernels.
struct CoreKernel {
  View<FixedPointRgb> sums;
  View<uint32_t> counts;
  View<uint32_t> directions;
  View<const Mat4> matrices;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t i = hash(x, y, 0u, 1u) % directions.size;
    const Vec3 n = unpack_direction(directions[i]);
    const Frame frame = make_frame(n);
    const Vec3 w = frame.to_world(frame.to_local(transform_vector(matrices[0], n)));
    const Vec3 p = transform_point(matrices[0], {static_cast<float>(x), static_cast<float>(y), to_unit_float(i)});
    const Ray ray{offset_origin(p, max_component(abs(p)) * gamma_bound(3), n, w), w, kInfinity};
    const Rgb value = exp(-ray.origin) * lerp(0.0f, safe_sqrt(max_component(w)), saturate(min_component(w)));
    if (is_finite(value) && !is_black(value)) sums[i].add(value * luminance(sums[i].value()));
    atomic_add(&counts[i], float_bits(length_squared(w)) ^ (Hit{}.valid() ? 1u : 0u));
    directions[i] = pack_direction(glm::normalize(w));
  }
};

template __global__ void run(CoreKernel, uint32_t, uint32_t);
template __global__ void run(PrimaryHitsKernel, uint32_t, uint32_t);
template __global__ void run(SurfaceKernel, uint32_t, uint32_t);
template __global__ void run(AuxiliaryKernel, uint32_t, uint32_t);
template __global__ void run(BdptKernel, uint32_t, uint32_t);
template __global__ void run(LightMediumKernel, uint32_t, uint32_t);
template __global__ void run(AddSplatsKernel, uint32_t, uint32_t);
template __global__ void run(PathKernel<RadianceOutput>, uint32_t, uint32_t);
template __global__ void run(PathKernel<RadianceOutput, SpecularOutput>, uint32_t, uint32_t);
template __global__ void run(PathKernel<RadianceOutput, FirstVertexOutput, SpecularOutput>, uint32_t, uint32_t);
template __global__ void run(PathKernel<RadianceOutput, RecordingOutput>, uint32_t, uint32_t);
template __global__ void run(PathKernel<RadianceOutput, RecordingOutput, SpecularOutput>, uint32_t, uint32_t);
template __global__ void run(PathKernel<RadianceOutput, RecordingOutput, FirstVertexOutput>, uint32_t, uint32_t);
template __global__ void run(PathKernel<RadianceOutput, RecordingOutput, FirstVertexOutput, SpecularOutput>, uint32_t,
                             uint32_t);
template __global__ void run(IncidentLightKernel, uint32_t, uint32_t);
template __global__ void run(RegionViewKernel, uint32_t, uint32_t);
template __global__ void run(CountKnownLightsKernel, uint32_t, uint32_t);
template __global__ void run(KnownLightsKernel, uint32_t, uint32_t);
template __global__ void run(OctreeMarkKernel, uint32_t, uint32_t);
template __global__ void run(OctreeParentsKernel, uint32_t, uint32_t);
template __global__ void run(OctreeLeafLinksKernel, uint32_t, uint32_t);
template __global__ void run(DeduplicateLightsKernel, uint32_t, uint32_t);
template __global__ void run(MergeLightsKernel, uint32_t, uint32_t);
template __global__ void run(CountBucketsKernel, uint32_t, uint32_t);
template __global__ void run(FillBucketsKernel, uint32_t, uint32_t);
template __global__ void run(BucketWeightsKernel, uint32_t, uint32_t);
template __global__ void run(AdaptQuadtreesKernel, uint32_t, uint32_t);
template __global__ void run(CellVisibilityKernel, uint32_t, uint32_t);
template __global__ void run(PathSpaceFilterKernel, uint32_t, uint32_t);
template __global__ void run(AdaptivePsfKernel, uint32_t, uint32_t);
template __global__ void run(PathGraphKernel, uint32_t, uint32_t);
template __global__ void run(ResolveCellsKernel, uint32_t, uint32_t);
template __global__ void run(MeasureChangesKernel, uint32_t, uint32_t);
template __global__ void run(MaintainCellsKernel, uint32_t, uint32_t);
template __global__ void run(InheritCellsKernel, uint32_t, uint32_t);
template __global__ void run(MoveCellsKernel, uint32_t, uint32_t);
template __global__ void run(MoveParentsKernel, uint32_t, uint32_t);
template __global__ void run(AddWaitingSamplesKernel, uint32_t, uint32_t);
template __global__ void run(AccumulateKernel, uint32_t, uint32_t);
template __global__ void run(PathKernel<RadianceOutput, FirstVertexOutput>, uint32_t, uint32_t);
template __global__ void run(StoreKernel, uint32_t, uint32_t);
template __global__ void run(ClaimKernel, uint32_t, uint32_t);
template __global__ void run(SourceKernel, uint32_t, uint32_t);
template __global__ void run(WinnerKernel, uint32_t, uint32_t);
template __global__ void run(CoveredKernel, uint32_t, uint32_t);
template __global__ void run(MoveKernel<Rgb>, uint32_t, uint32_t);
template __global__ void run(MoveKernel<uint32_t>, uint32_t, uint32_t);
template __global__ void run(MoveMomentsKernel, uint32_t, uint32_t);
template __global__ void run(LimitKernel, uint32_t, uint32_t);
template __global__ void run(BackwardHistoryKernel, uint32_t, uint32_t);
template __global__ void run(FillKernel, uint32_t, uint32_t);
template __global__ void run(SpecularHistoryKernel, uint32_t, uint32_t);
template __global__ void run(PaperAllocationKernel, uint32_t, uint32_t);
template __global__ void run(OwnStatisticsKernel, uint32_t, uint32_t);
template __global__ void run(PoolRowsKernel, uint32_t, uint32_t);
template __global__ void run(PooledDeviationKernel, uint32_t, uint32_t);
template __global__ void run(PooledAllocationKernel, uint32_t, uint32_t);
template __global__ void run(FeatureKernel, uint32_t, uint32_t);
template __global__ void run(MeasureEdgesKernel, uint32_t, uint32_t);
template __global__ void run(CompareBlocksKernel, uint32_t, uint32_t);
template __global__ void run(DiscountBlocksKernel, uint32_t, uint32_t);
template __global__ void run(ReplaceEmissionKernel, uint32_t, uint32_t);
template __global__ void run(FireflyFactorKernel, uint32_t, uint32_t);
template __global__ void run(FireflyScaleKernel, uint32_t, uint32_t);
template __global__ void run(SplitLightKernel, uint32_t, uint32_t);
template __global__ void run(PictureHistoryKernel, uint32_t, uint32_t);
template __global__ void run(ConvergeKernel, uint32_t, uint32_t);
template __global__ void run(BlockNoiseKernel, uint32_t, uint32_t);
template __global__ void run(BmfrAccumulateKernel, uint32_t, uint32_t);
template __global__ void run(BlockRegressionKernel, uint32_t, uint32_t);
template __global__ void run(BmfrPresentKernel, uint32_t, uint32_t);
template __global__ void run(BmfrPresentPartsKernel, uint32_t, uint32_t);
template __global__ void run(SvgfAccumulateKernel, uint32_t, uint32_t);
template __global__ void run(SvgfPrepareKernel, uint32_t, uint32_t);
template __global__ void run(AtrousKernel, uint32_t, uint32_t);
template __global__ void run(SvgfPresentKernel, uint32_t, uint32_t);
template __global__ void run(SvgfPresentPartsKernel, uint32_t, uint32_t);
template __global__ void run(OidnAuxiliaryKernel, uint32_t, uint32_t);

}  // namespace
}  // namespace relume
