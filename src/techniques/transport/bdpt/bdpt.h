// Kernels of bidirectional path tracing ([Veach97], ch. 10; [Sun20], ch. 3 and 4) and of light tracing, its special
// case. The steps are in light_subpath.h and camera_subpath.h.
#pragma once

#include "techniques/transport/bdpt/camera_subpath.h"
#include "techniques/transport/bdpt/light_subpath.h"

namespace relume {

/// Output of the radiance of camera subpaths. Outputs of other kinds have the same functions, with a policy for
/// trace_camera_subpath().
struct SubpathRadiance {
  View<Rgb> radiance;  ///< of this sample, without splats; may be not finite

  RELUME_HD NoPolicy policy(const SampleIndex&, uint32_t, uint32_t, uint32_t /*pixel*/) const { return {}; }
  RELUME_HD void finish(uint32_t pixel, const NoPolicy&, const Rgb& seen) const { radiance[pixel] = seen; }
  RELUME_HD void leave_out(uint32_t pixel) const { radiance[pixel] = Rgb(0); }
};

/// Traces one light and one camera subpath per pixel, with all their connections. `Context`: BdptContext or
/// LearningContext. `Sink`: SubpathRadiance or another output.
template <typename Context, typename Sink>
struct BidirectionalKernel {
  Context context;
  SampleIndex index;
  View<const Hit> hits;
  View<const uint32_t> allocation;  ///< paths of the pixel, 0 or 1; empty: 1
  Sink output;
  View<uint32_t> rays;       ///< of this sample
  View<uint64_t> saturated;  ///< one counter of clamped splats
  View<uint64_t> nonfinite;  ///< one counter of splats left out as not finite
  // Of the form for one pixel: memory of LightVertices for `kept_rows` rows. A launch traces at most as many.
  View<PathVertex> vertices = {};
  View<CameraConnection> to_camera = {};
  uint32_t kept_rows = 0;
  View<GuidedPoint> guides = {};  ///< as many; empty: camera subpaths are not guided

  /// The same kernel with another context and output.
  template <typename OtherContext, typename OtherSink>
  BidirectionalKernel<OtherContext, OtherSink> with(const OtherContext& c, const OtherSink& sink) const {
    return {c, index, hits, allocation, sink, rays, saturated, nonfinite, vertices, to_camera, kept_rows, guides};
  }

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t size = context.max_kept_vertices();
    const uint32_t first = (y % kept_rows * context.width + x) * size;
    LightVertices kept{{vertices.data + first, size}, {to_camera.data + first, size}};
    if (Context::kLearns && !guides.empty()) kept.guides = {guides.data + first, size};
    trace(x, y, kept);
  }

  /// Host: threads have enough memory on their stack.
  void operator()(const Tile& tile) const {
    LightVertexArrays arrays;
    GuidedPoint guided[Context::kLearns ? kMaxLightVertices - 1 : 1u];
    LightVertices kept = arrays.view();
    if (Context::kLearns) kept.guides = {guided, kMaxLightVertices - 1};
    for (uint32_t y = tile.y0; y < tile.y1; ++y) {
      for (uint32_t x = tile.x0; x < tile.x1; ++x) trace(x, y, kept);
    }
  }

 private:
  /// Number for has_negative_sign(). With a blue-noise tile, light subpaths repeat: repetitions are one light path.
  RELUME_HD uint32_t number_of_subpath(uint32_t x, uint32_t y) const {
    if (index.tile.empty()) return y * context.width + x;
    return y % kBlueNoiseEdge * kBlueNoiseEdge + x % kBlueNoiseEdge;
  }

  /// `kept`: memory for the light subpath.
  RELUME_HD void trace(uint32_t x, uint32_t y, LightVertices kept) const {
    const uint32_t pixel = y * context.width + x;
    context.begin_records(pixel);
    if (!allocation.empty() && allocation[pixel] == 0) {
      output.leave_out(pixel);
      rays[pixel] = 0;
      skip_records(context, pixel);
      return;
    }
    BdptCounters counters;
    counters.subtracts = has_negative_sign(number_of_subpath(x, y));
    Sampler light_sampler = index.sampler(x, y);
    trace_light_subpath(context, light_sampler, kept, counters);
    Sampler sampler = index.sampler(x, y);
    ConnectionRoulette roulette;
    auto policy = output.policy(index, x, y, pixel);
    const Rgb seen = trace_camera_subpath(context, x, y, hits[pixel], kept.view(), sampler, roulette, counters,
                                          OneLightSubpath{}, policy);
    try_camera_connections(context, kept, roulette, counters);
    output.finish(pixel, policy, seen);
    rays[pixel] = counters.rays;
    if (counters.saturated > 0) atomic_add(&saturated[0], uint64_t{counters.saturated});
    if (counters.nonfinite > 0) atomic_add(&nonfinite[0], uint64_t{counters.nonfinite});
  }
};

using BdptKernel = BidirectionalKernel<BdptContext, SubpathRadiance>;
template <typename Context>
using BdptKernelOf = BidirectionalKernel<Context, SubpathRadiance>;

/// The caustic layer of a frame, part of its radiance. Empty: not wanted.
struct CausticViews {
  View<Rgb> radiance;
  View<Rgb> difference;  ///< as kCausticDifference

  RELUME_HD bool empty() const { return radiance.empty(); }
  RELUME_HD void set(uint32_t pixel, const Rgb& light, const Rgb& signed_light) const {
    radiance[pixel] = light;
    difference[pixel] = signed_light;
  }
};

/// Adds the splats of the frame to the radiance of its samples and clears them.
struct AddSplatsKernel {
  View<FixedPointRgb> splats;
  View<Rgb> radiance;
  View<Rgb> brought;  ///< radiance of the splats; may be empty
  float scale = 1;    ///< pixels over light subpaths of the frame
  uint32_t width = 0;
  CausticViews caustics = {};
  View<FixedPointRgb> differences = {};  ///< BdptContext::splat_differences, for `caustics`
  bool joins_merged = false;             ///< `caustics` holds merged light, to which splats are added

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Rgb splat = splats[pixel].value() * scale;
    radiance[pixel] += splat;
    if (!brought.empty()) brought[pixel] = splat;
    if (!caustics.empty()) add_to_layer(pixel, splat);
    splats[pixel] = {};
  }

 private:
  RELUME_HD void add_to_layer(uint32_t pixel, const Rgb& splat) const {
    const Rgb difference = differences[pixel].value() * scale;
    if (joins_merged) {
      caustics.set(pixel, caustics.radiance[pixel] + splat, caustics.difference[pixel] + difference);
    } else {
      caustics.set(pixel, splat, difference);
    }
    differences[pixel] = {};
  }
};

}  // namespace relume
