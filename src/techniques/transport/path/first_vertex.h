// What a sample found at its first vertex: which directions it took from there, and the light that came from them.
// Histories need it to judge what a sample is worth from another viewpoint or under moved lights.
#pragma once

#include "framebuffer/buffer_key.h"
#include "techniques/transport/path/path_kernel.h"

namespace relume {

struct FirstVertex {
  Vec3 scatter{0};   ///< direction sampled from the BSDF; zero: none
  Rgb indirect{0};   ///< what arrived from there, times cos / pdf: the BSDF times this was reflected
  Vec3 to_light{0};  ///< direction of next event estimation; zero: none
  Rgb direct{0};     ///< what arrived from there, alike
  LightId light = kNoLight;
  Vec2 light_u{0};        ///< with which its point was chosen
  float light_value = 0;  ///< luminance of radiance · cos / pdf_w of that point, 0 if hidden
  float light_scale = 0;  ///< MIS weight / pmf: direct = light_value · light_scale in luminance
};

/// What each pixel's path found at its first vertex.
inline constexpr BufferKey<FirstVertex> kFirstVertices{"first-vertices"};

/// Fills an empty one while a path is traced; none if there is none.
struct FirstVertexObserver {
  FirstVertex* vertex;
  Rgb radiance_before{0};
  Rgb throughput{0};

  RELUME_HD void emitted(const PathState&, bool) {}
  RELUME_HD bool arrived(const SurfacePoint&, const PathState&) { return true; }
  RELUME_HD void connected(const SurfacePoint&, const PathState& path, const Connection& c, bool visible) {
    if (!vertex || path.bounce != 0) return;
    vertex->to_light = c.ray.direction;
    vertex->light = c.light;
    vertex->light_u = c.u;
    vertex->light_scale = c.scale;
    if (!visible) return;
    vertex->light_value = luminance(c.irradiance);
    vertex->direct = c.irradiance * c.scale;
  }
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, const PathState& after) {
    if (!vertex || after.bounce != 1 || s.delta) return;
    vertex->scatter = s.wi;
    radiance_before = after.radiance;
    throughput = after.throughput * (s.pdf_w / shading_cosine(sp, s.wi));
  }
  RELUME_HD void finished(const PathState& path) {
    if (!vertex) return;
    const Rgb found = path.radiance - radiance_before;
    for (int c = 0; c < 3; ++c) vertex->indirect[c] = throughput[c] > 0.0f ? found[c] / throughput[c] : 0.0f;
  }
};

/// Begins the record of a pixel's path; none if there are no records.
RELUME_HD inline FirstVertexObserver watch_first_vertex(const View<FirstVertex>& vertices, uint32_t pixel) {
  if (vertices.empty()) return {nullptr};
  vertices[pixel] = {};
  return {&vertices[pixel]};
}

/// Keeps radiance and first vertex of each path.
struct FirstVertexObservation {
  View<Rgb> radiance;  ///< of this sample; may be not finite
  View<FirstVertex> first_vertices;

  RELUME_HD FirstVertexObserver observer(const SampleIndex&, uint32_t, uint32_t, uint32_t pixel) const {
    return watch_first_vertex(first_vertices, pixel);
  }
  RELUME_HD void finish(uint32_t pixel, const FirstVertexObserver&, const PathState& path) const {
    radiance[pixel] = path.radiance;
  }
  RELUME_HD void leave_out(uint32_t pixel) const {
    radiance[pixel] = Rgb(0);
    first_vertices[pixel] = {};
  }
};

using FirstVertexPathKernel = ObservedPathKernel<FirstVertexObservation>;

}  // namespace relume
