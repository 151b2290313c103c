// Kernels of vertex connection and merging. Light subpaths come first, because any camera vertex may merge with any of
// them.
#pragma once

#include "techniques/transport/bdpt/bdpt.h"
#include "techniques/transport/vcm/merging.h"

namespace relume {

/// Traces light subpaths, keeps their vertices, and adds their splats. Runs on a grid as wide as the image, with enough
/// rows.
template <typename Context>
struct LightSubpathKernelOf {
  Context context;
  SampleIndex index;  ///< of light subpaths: without `taken` and `tile`, because they reach all pixels
  View<PathVertex> vertices;
  View<GuidedPoint> guides;  ///< of the vertices; empty: camera subpaths are not guided
  View<uint32_t> counts;     ///< vertices by light subpath
  View<uint32_t> keys;       ///< of MergeGrid, by slot; those of empty slots are `grid.buckets`; may be empty
  View<uint32_t> rays;       ///< by light subpath
  View<uint64_t> saturated;
  View<uint64_t> nonfinite;
  MergeGrid grid;
  uint32_t stride = 1;  ///< slots of a light subpath
  uint32_t paths = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t path = y * context.width + x;
    if (path >= paths) return;
    LightVertices kept{{vertices.data + size_t{path} * stride, stride}, {}};
    if (Context::kLearns && !guides.empty()) kept.guides = {guides.data + size_t{path} * stride, stride};
    BdptCounters counters;
    counters.subtracts = has_negative_sign(path);
    Sampler sampler = index.sampler(x, y);
    trace_light_subpath(context, sampler, kept, counters);
    for (uint32_t i = 0; !keys.empty() && i < stride; ++i)
      keys[path * stride + i] = i < kept.count ? grid.key_of(kept.vertices[i]) : grid.buckets;
    counts[path] = kept.count;
    rays[path] = counters.rays;
    if (counters.saturated > 0) atomic_add(&saturated[0], uint64_t{counters.saturated});
    if (counters.nonfinite > 0) atomic_add(&nonfinite[0], uint64_t{counters.nonfinite});
  }
};

/// Traces a camera subpath per pixel. It connects to one light subpath or to random vertices, and merges with all.
/// `Context` and `Sink`: as for BidirectionalKernel.
template <typename Context, typename Sink>
struct MergingKernel {
  Context context;
  SampleIndex index;
  View<const Hit> hits;
  View<const uint32_t> allocation;  ///< paths of the pixel, 0 or 1; empty: 1
  Sink output;
  View<uint32_t> rays;  ///< of this sample, and of the light subpath with the number of the pixel
  View<const PathVertex> vertices;
  View<const GuidedPoint> guides;  ///< of the vertices; empty: camera subpaths are not guided
  View<const uint32_t> counts;     ///< vertices by light subpath; empty: no light subpaths
  View<const uint32_t> light_rays;
  uint32_t stride = 1;  ///< slots of a light subpath
  uint32_t pixels = 0;
  LightVertexGrid grid;
  CausticViews caustics = {};  ///< merged part of the caustic layer

  /// The same kernel with another context and output.
  template <typename OtherContext, typename OtherSink>
  MergingKernel<OtherContext, OtherSink> with(const OtherContext& c, const OtherSink& sink) const {
    return {c,      index,  hits,       allocation, sink,   rays, vertices,
            guides, counts, light_rays, stride,     pixels, grid, caustics};
  }

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * context.width + x;
    const uint32_t rays_of_light = pixel < counts.size ? light_rays[pixel] : 0;
    context.begin_records(pixel);
    if (!allocation.empty() && allocation[pixel] == 0) {
      output.leave_out(pixel);
      rays[pixel] = rays_of_light;
      skip_records(context, pixel);
      if (!caustics.empty()) caustics.set(pixel, Rgb(0), Rgb(0));
      return;
    }
    BdptCounters counters;
    Sampler sampler = index.sampler(x, y);
    ConnectionRoulette roulette;
    CausticSum merged;
    bool reached = false;
    const GridWithCaustics others{grid, caustics.empty() ? nullptr : &merged, &reached};
    auto policy = output.policy(index, x, y, pixel);
    const Rgb seen =
        trace_camera_subpath(context, x, y, hits[pixel], connected(pixel), sampler, roulette, counters, others, policy);
    output.finish(pixel, policy, seen);
    if (!is_finite(merged.light) || !is_finite(merged.difference)) merged = {};
    if (!caustics.empty()) caustics.set(pixel, merged.light, merged.difference);
    rays[pixel] = counters.rays + rays_of_light;
  }

 private:
  /// Vertices of the light subpath to which the pixel connects; none if it connects to random vertices.
  RELUME_HD KeptVertices connected(uint32_t pixel) const {
    if (counts.empty() || grid.connections > 0) return {};
    const auto path = static_cast<uint32_t>(uint64_t{pixel} * counts.size / pixels);
    const size_t first = size_t{path} * stride;
    KeptVertices kept{{vertices.data + first, counts[path]}};
    if (Context::kLearns && !guides.empty()) kept.guides = {guides.data + first, counts[path]};
    return kept;
  }
};

using VcmKernel = MergingKernel<BdptContext, SubpathRadiance>;

}  // namespace relume
