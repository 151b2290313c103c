// First stage of all reservoirs for direct light: the receiver of a pixel and its own reservoir.
#pragma once

#include "techniques/light_sampling/markov_chain_lights/light_chain_recorder.h"
#include "techniques/reuse/reservoir/choose_light.h"
#include "techniques/reuse/reservoir/recorded_light.h"
#include "techniques/reuse/reservoir/reuse_image.h"
#include "techniques/spatial/octree/path_recording.h"
#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/specular_part.h"

namespace relume {

/// Records a reservoir's sample as the light sample of the pixel's first vertex, without its share of the pixel's
/// light. The record's `light_u` are the coordinates of a LightPoint. If the record holds light of splats, it keeps
/// their direction.
RELUME_HD inline void record_candidate(const SceneView& scene, const Receiver& r, const LightReservoir& reservoir,
                                       bool visible, FirstVertex& vertex) {
  const LightSample light = light_at(scene.lights, reservoir.sample, r.sp.position);
  if (is_black(vertex.direct)) vertex.to_light = light.wi;
  vertex.light = reservoir.sample.light;
  vertex.light_u = reservoir.sample.coordinates;
  vertex.light_scale = reservoir.weight;
  const float factor = visible ? shading_cosine(r.sp, light.wi) / light.pdf_w : 0.0f;
  vertex.light_value = luminance(light.radiance * factor);
}

/// Records a reservoir's sample in the chains of light selection, as paths record a light sample of their first vertex.
/// Its score is its estimate of the direct light. Not inlined, to bound the stack of kernels.
RELUME_HD_NOINLINE inline void record_in_chains(const LightChainRecording& chains, const Receiver& r,
                                                const LightReservoir& reservoir, bool visible, uint32_t pixel) {
  LightChainRecorder recorder;
  recorder.recording = &chains;
  recorder.pixel = pixel;
  recorder.pick(r.sp, 0, reservoir.sample.light);
  if (visible) recorder.offer(r.sp, 0, reservoir.sample.light, reservoir.target * reservoir.weight);
}

struct CandidateStage {
  PathContext context;
  SampleIndex index;
  View<const Hit> hits;
  View<const FirstScatter> scatters;
  View<const float> chances;         ///< kScatterChances; empty: no cache modifies paths
  View<FirstVertex> first_vertices;  ///< receives the chosen light samples; may be empty
  // Each receives the chosen lights, from which light selection learns, and may be empty.
  PathRecording recording;
  LightChainRecording chains;
  uint32_t light_candidates = 1;
  uint32_t width = 0;
  float wavelength_nm = kNoWavelength;  ///< of all paths of the frame; kNoWavelength: every path has its own

  /// Fills the receiver of pixel (x, y). Returns false if it has none: no surface, or delta lobes only.
  RELUME_HD bool receive(uint32_t x, uint32_t y, const Sampler& sampler, ReceiverRecord& record, Receiver& r) const {
    const uint32_t pixel = y * width + x;
    if (!hits[pixel].valid() || context.max_bounces == 0) return false;
    record = record_of(context.scene, x, y, sampler, hits[pixel]);
    if (wavelength_nm != kNoWavelength) record.wavelength_nm = wavelength_nm;
    make_receiver(context.scene, record, r);
    r.sp.region = scatters[pixel].region;
    return !r.sp.bsdf.empty() && has_non_delta(r.sp.bsdf);
  }

  /// Chooses among the pixel's candidates and traces a ray to the choice. The reservoir's weight is 0 if that is
  /// hidden.
  RELUME_HD LightReservoir choose(uint32_t pixel, const Receiver& r, Sampler& sampler, ChoiceNumbers& numbers,
                                  uint32_t& rays) const {
    const CandidateSource source{context, light_candidates, chances.empty() ? 1.0f : chances[pixel], chances.empty()};
    LightReservoir own = choose_light(source, r, scatters[pixel], sampler, numbers);
    if (!(own.weight > 0.0f) || !is_finite(own.weight)) return own;
    ++rays;
    const bool visible = sees(context.scene, r, light_at(context.scene.lights, own.sample, r.sp.position));
    if (!recording.samples.empty() && recording.vertices > 0)
      recording.sample(0, pixel).light = own.sample.light | (visible ? kVisibleLight : 0u);
    if (visible) recording.offer(0, pixel, own.sample.light, own.target * own.weight);
    if (chains.out.vertices > 0) record_in_chains(chains, r, own, visible, pixel);
    if (!first_vertices.empty()) record_candidate(context.scene, r, own, visible, first_vertices[pixel]);
    if (!visible) own.weight = 0;
    return own;
  }
};

/// Planes to which reservoirs add their light.
struct ReservoirImage {
  ReuseImage planes;
  View<FirstVertex> first_vertices = {};  ///< records of what is added; may be empty

  /// Adds the light of a reservoir whose sample the receiver sees.
  RELUME_HD void add(const SceneView& scene, const Receiver& r, const LightReservoir& reservoir, uint32_t pixel) const {
    if (!planes.takes(reservoir.weight, pixel)) return;
    const LightSample light = light_at(scene.lights, reservoir.sample, r.sp.position);
    const Rgb value = r.path.throughput * reflected(scene, r, light) * reservoir.weight;
    planes.radiance[pixel] += value;
    if (!planes.specular.empty()) planes.specular[pixel] += value * specular_share(r.sp, light.wi);
    if (!first_vertices.empty()) record(scene, r, reservoir, light, first_vertices[pixel]);
  }

 private:
  /// Records the light of the reservoir like a connection of next event estimation, beside that of splats.
  RELUME_HD static void record(const SceneView& scene, const Receiver& r, const LightReservoir& reservoir,
                               const LightSample& light, FirstVertex& vertex) {
    record_candidate(scene, r, reservoir, true, vertex);
    Rgb direct = light.radiance * (shading_cosine(r.sp, light.wi) / light.pdf_w * reservoir.weight);
    if (scene.absorbs) direct *= transmittance(medium_along(scene, r.sp, light.wi, r.path.medium), light.distance);
    if (r.path.dispersed || disperses(scene, r.sp, light.wi)) direct *= wavelength_weight(r.path.wavelength_nm);
    if (is_black(vertex.direct)) {
      vertex.direct = direct;
    } else {
      constexpr uint32_t kSalt = 0x53504c54u;
      add_to_record(r.sp, light.wi, direct, to_unit_float(hash(r.ray_id, kSalt)), vertex.to_light, vertex.direct);
    }
  }
};

}  // namespace relume
