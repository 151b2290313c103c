// Record of the light that a path finds beyond its second vertex. Reservoirs (techniques/reuse) resample this light,
// and the path keeps the rest: direct light at the primary hit, and everything after a delta lobe there.
#pragma once

#include "core/octahedral.h"
#include "framebuffer/buffer_key.h"
#include "techniques/transport/path/path_kernel.h"

namespace relume {

/// A surface point met by a direction that was sampled at a primary hit, and the light that it reflects to that hit.
struct IndirectVertex {
  // Traits.
  static constexpr uint32_t kFrontFace = 1;  ///< the lit side is the front
  static constexpr uint32_t kLambert = 2;    ///< reflects the same light in all directions
  static constexpr uint32_t kBound = 4;      ///< its light is valid for its own primary hit only

  uint32_t instance = kNoHit;  ///< kNoHit: none
  uint32_t primitive = 0;
  float u = 0;  ///< as in Hit
  float v = 0;
  uint32_t normal = 0;  ///< SurfacePoint::ns, packed
  uint32_t traits = 0;
  float alpha = 0;        ///< of the narrowest lobe; 0 with delta lobes, 1 without glossy ones
  Rgb radiance{0};        ///< towards the primary hit, without the surface's own emission
  uint32_t pixel = 0;     ///< of the path that found the light
  uint32_t seed = 0;      ///< SampleIndex::seed of that path
  uint32_t sequence = 0;  ///< SampleIndex::sequence of that path
  uint32_t element = 0;   ///< SampleIndex::sample_of() that path

  RELUME_HD bool valid() const { return instance != kNoHit; }
  RELUME_HD bool has(uint32_t trait) const { return (traits & trait) != 0u; }
  RELUME_HD Hit hit() const { return {instance, primitive, u, v, kInfinity}; }
};

struct IndirectSample {
  IndirectVertex vertex;
  float weight = 0;  ///< one over the vertex's density, per steradian at the primary hit; 0: no sample
};

/// Sample of the path of each pixel.
inline constexpr BufferKey<IndirectSample> kIndirectSamples{"indirect-samples"};

/// Cosine between a vertex's shading normal and a viewer below which the normal may be bent to that viewer. It exceeds
/// kMinShadingCosine by the error of packed normals.
inline constexpr float kLeastVertexCosine = 2.0f * kMinShadingCosine;

/// Records the sample of a path, and removes its light. From the second vertex on, the path has throughput 1 and no ray
/// cone, so its light depends on the vertex alone, not on the pixel.
struct IndirectSamplePolicy : NoPolicy {
  IndirectSample* sample;  ///< empty at the start
  Rgb scattered_throughput{0};
  Rgb base{1};  ///< factor of the throughput in the image
  Rgb unit{1};  ///< throughput at the second vertex
  Rgb kept{0};  ///< radiance that stays with the path
  float weight = 0;
  bool candidate = false;  ///< whether the first direction comes from a lobe that has a density
  bool was_dispersed = false;
  bool taken = false;  ///< whether throughput and radiance of the path count from the second vertex

  RELUME_HD void hit_surface(const SurfacePoint&, const PathState& path) {
    if (!candidate || path.bounce != 1) return;
    unit = path.throughput;
    was_dispersed = path.dispersed;
  }
  template <typename Earlier>
  RELUME_HD bool arrived(const SurfacePoint& sp, PathState& path, Earlier& earlier) {
    if (!candidate || path.bounce != 1) return true;
    take(sp, path);
    earlier.rebased(kept, base * unit);
    return true;
  }
  RELUME_HD void scattered(const SurfacePoint&, const BsdfSample& s, PathState& after) {
    if (after.bounce != 1 || s.delta) return;
    candidate = true;
    weight = s.resampling * after.indirect_weight / s.pdf_w;
    scattered_throughput = after.throughput;
    after.cone_width = 0;
    after.cone_spread = 0;
  }
  /// A later cache has changed the units of the path at its primary hit.
  RELUME_HD void rebased(const Rgb&, const Rgb& next) { base = next; }
  RELUME_HD void finished(PathState& path) {
    if (!taken) return;
    const Rgb found = path.radiance;
    path.radiance = kept;
    if (!is_finite(found)) {
      path.radiance += found;  // is counted there
      *sample = {};
      return;
    }
    sample->vertex.radiance = found * segment_transmittance();
    if (path.dispersed) sample->vertex.traits |= IndirectVertex::kBound;
    sample->weight = weight;
  }

 protected:
  RELUME_HD void take(const SurfacePoint& sp, PathState& path) {
    IndirectVertex& vertex = sample->vertex;
    vertex.instance = sp.instance;
    vertex.primitive = sp.primitive;
    vertex.u = sp.barycentric.x;
    vertex.v = sp.barycentric.y;
    vertex.normal = pack_direction(sp.ns);
    vertex.alpha = has_delta(sp.bsdf) ? 0.0f : narrowest_alpha(sp.bsdf);
    const bool bent = !(glm::dot(unpack_direction(vertex.normal), sp.wo) >= kLeastVertexCosine);
    vertex.traits = (sp.front_face ? IndirectVertex::kFrontFace : 0u) |
                    (is_lambert(sp.bsdf) ? IndirectVertex::kLambert : 0u) |
                    (bent || !is_black(path.medium) ? IndirectVertex::kBound : 0u);
    kept = path.radiance;
    taken = true;
    path.radiance = Rgb(0);
    path.throughput = path.dispersed && !was_dispersed ? wavelength_weight(path.wavelength_nm) : Rgb(1);
    path.eta_scale = max_component(path.throughput);
    path.rr_reference = 1.0f;
  }

  /// Transmittance between the first two vertices, which belongs to the sample: media bind it to its pixel.
  RELUME_HD Rgb segment_transmittance() const {
    Rgb t(1);
    for (int c = 0; c < 3; ++c) {
      if (scattered_throughput[c] > 0.0f) t[c] = unit[c] / scattered_throughput[c];
    }
    return t;
  }
};

/// Output of the sample of each path. Must follow outputs whose policies need whole paths; these learn of the change of
/// units by PathEvents::rebased(). Later outputs see the complete path without the sample. Cells of primary hits
/// follow, since they hold no light of samples. Path graphs, which find the light of samples, precede.
struct IndirectSampleOutput {
  using Policy = IndirectSamplePolicy;

  View<IndirectSample> samples;

  RELUME_HD IndirectSamplePolicy policy(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t pixel) const {
    IndirectSample& sample = samples[pixel];
    sample = {};
    sample.vertex.pixel = pixel;
    sample.vertex.seed = index.seed;
    sample.vertex.sequence = index.sequence;
    sample.vertex.element = index.sample_of(x, y);
    IndirectSamplePolicy policy;
    policy.sample = &sample;
    return policy;
  }
  RELUME_HD void finish(uint32_t, const IndirectSamplePolicy&, const PathState&) const {}
  RELUME_HD void leave_out(uint32_t pixel) const { samples[pixel] = {}; }
};

}  // namespace relume
