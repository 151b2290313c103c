// Record of a sample at its first vertex: directions from there, and the light that arrives along them. Histories use
// it to evaluate a sample for another viewpoint or under moved lights.
#pragma once

#include "framebuffer/buffer_key.h"
#include "techniques/transport/path/path_kernel.h"

namespace relume {

struct FirstVertex {
  Vec3 scatter{0};   ///< direction sampled by the path, or one of several that represents them; zero: none
  Rgb indirect{0};   ///< arriving radiance · cos / pdf along `scatter`; the BSDF scales it to the reflected light
  Vec3 to_light{0};  ///< direction of next event estimation; zero: none
  Rgb direct{0};     ///< arriving radiance · cos / pdf along `to_light`, with its MIS weight
  LightId light = kNoLight;
  Vec2 light_u{0};        ///< random numbers that chose the point on `light`; of reservoirs: the point's coordinates
  float light_value = 0;  ///< luminance of radiance · cos / pdf_w at that point; 0 if hidden
  float light_scale = 0;  ///< MIS weight / pmf: direct = light_value · light_scale in luminance
};

/// First vertex of the path of each pixel.
inline constexpr BufferKey<FirstVertex> kFirstVertices{"first-vertices"};

/// Records the first vertex of a path.
struct FirstVertexPolicy : NoPolicy {
  FirstVertex* vertex;  ///< empty at the start
  Rgb radiance_before{0};
  Rgb throughput{0};

  RELUME_HD void connected(const SurfacePoint&, const PathState& path, const Connection& c, bool visible) {
    if (path.bounce != 0) return;
    vertex->to_light = c.ray.direction;
    vertex->light = c.light;
    vertex->light_u = c.u;
    vertex->light_scale = c.scale;
    if (!visible) return;
    vertex->light_value = luminance(c.irradiance);
    vertex->direct = c.irradiance * c.scale;
    // The wavelength weight is not part of the BSDF or of `light_value`, so `direct` includes it.
    if (c.dispersed) vertex->direct *= wavelength_weight(path.wavelength_nm);
  }
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, const PathState& after) {
    if (after.bounce != 1 || s.delta) return;
    vertex->scatter = s.wi;
    radiance_before = after.radiance;
    throughput = after.throughput * (s.pdf_w / (s.resampling * shading_cosine(sp, s.wi)));
    // These weights are not part of the BSDF, so `indirect` includes them.
    if (after.dispersed) throughput /= wavelength_weight(after.wavelength_nm);
    throughput /= after.indirect_weight;
  }
  RELUME_HD void finished(const PathState& path) { finish_with(path.radiance); }
  /// Completes the record of a path that has found `radiance`, in the units of its throughput at the first vertex.
  RELUME_HD void finish_with(const Rgb& radiance) {
    const Rgb found = radiance - radiance_before;
    for (int c = 0; c < 3; ++c) vertex->indirect[c] = throughput[c] > 0.0f ? found[c] / throughput[c] : 0.0f;
  }
};

/// Output of the first vertex of each path.
struct FirstVertexOutput {
  using Policy = FirstVertexPolicy;

  View<FirstVertex> first_vertices;

  RELUME_HD FirstVertexPolicy policy(const SampleIndex&, uint32_t, uint32_t, uint32_t pixel) const {
    first_vertices[pixel] = {};
    FirstVertexPolicy policy;
    policy.vertex = &first_vertices[pixel];
    return policy;
  }
  RELUME_HD void finish(uint32_t, const FirstVertexPolicy&, const PathState&) const {}
  RELUME_HD void leave_out(uint32_t pixel) const { first_vertices[pixel] = {}; }
};

}  // namespace relume
