// Records the first vertices of paths.
#pragma once

#include "core/hash.h"
#include "core/octahedral.h"
#include "scene/surface_point.h"
#include "techniques/light_sampling/light_selection/light_feedback.h"
#include "techniques/spatial/octree/region_lookup.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

struct PathRecorder;

/// Creates recorders. Must outlive them.
struct PathRecording {
  OctreeView octree;    ///< tree in which samples are recorded
  RegionLookup lookup;  ///< of the tree from which paths take estimates
  View<VertexSample> samples;
  uint32_t vertices = 0;
  uint32_t pixels = 0;
  bool frozen = false;                     ///< whether the trees differ: `lookup` is of an earlier frame of the epoch
  View<LightFeedback> feedback = {};       ///< by pixel, for light selection that learns per pixel; empty: none
  uint32_t feedback_seed = 0;              ///< of its choices, different in each frame
  View<ImportanceSample> importance = {};  ///< by address of `samples`; empty: not recorded

  RELUME_HD PathRecorder begin(uint32_t pixel) const;
  /// The regions of a vertex without jitter.
  RELUME_HD RegionPair find(const SurfacePoint& sp) const {
    if (frozen) return {lookup.tree.find(sp.previous_position), octree.find(sp.position)};
    return octree.find_pair(sp.previous_position, sp.position);
  }
  RELUME_HD VertexSample& sample(uint32_t vertex, uint32_t pixel) const { return samples[vertex * pixels + pixel]; }
  RELUME_HD bool records_importance(uint32_t vertex) const { return !importance.empty() && vertex < vertices; }
  /// Stores importance that arrived from direction `w` at a vertex. `value`: as ImportanceSample::value; may be not
  /// finite.
  RELUME_HD void store_importance(uint32_t vertex, uint32_t pixel, const Vec3& w, float value) const {
    const bool counts = value > 0.0f && is_finite(value);
    importance[vertex * pixels + pixel] = {pack_square(square_from_direction(w)), counts ? value : 0.0f};
  }
  /// Stores the surface at a vertex in the feedback of its pixel, if it is the first.
  RELUME_HD void meet(uint32_t vertex, uint32_t pixel, const SurfacePoint& sp) const {
    if (vertex > 0 || feedback.empty()) return;
    feedback[pixel].position = sp.position;
    feedback[pixel].previous_position = sp.previous_position;
  }
  /// Adds an unblocked connection at a vertex to the feedback of its pixel. `contribution`: luminance.
  RELUME_HD void offer(uint32_t vertex, uint32_t pixel, LightId light, float contribution) const {
    if (feedback.empty()) return;
    feedback[pixel].offer(light, vertex > 0, contribution, to_unit_float(hash(feedback_seed, pixel, vertex)));
  }
  /// Clears the records of `pixel`.
  RELUME_HD void skip(uint32_t pixel) const {
    for (uint32_t v = 0; v < vertices; ++v) sample(v, pixel) = {};
  }
};

/// The policy of one path (techniques/transport/path/path_policy.h). The radiance sampled along a direction is the
/// increase of the path's radiance since its choice, divided by the throughput at that time. Emission that next event
/// estimation could sample is excluded. The recorder is small, because hosts keep one per path in flight.
struct PathRecorder {
  const PathRecording* recording;
  uint32_t pixel;
  uint32_t current = 0;                  ///< current vertex
  uint32_t reached = 0;                  ///< number of recorded vertices; valid elements of the arrays below
  Rgb throughput[kMaxRecordedVertices];  ///< throughput after the direction was chosen, without wavelength_weight()
  Rgb radiance[kMaxRecordedVertices];    ///< radiance of the path up to then, with the excluded emission
  float factor[kMaxRecordedVertices];    ///< cos θ / pdf_w, with the factor of resampling; 0: no direction

  template <typename Path>
  RELUME_HD void hit_surface(const SurfacePoint&, const Path&) {}

  template <typename Path>
  RELUME_HD bool arrived(SurfacePoint& sp, const Path& path) {
    const RegionPair regions = recording->find(sp);
    const uint32_t v = path.bounce;
    const RegionLookup& lookup = recording->lookup;
    sp.region = lookup.jitter > 0.0f
                    ? lookup.tree.find_near(lookup.tree.quantise(sp.previous_position), lookup.jitter, random(v))
                    : regions.sample;
    begin_vertex(v, regions.store);
    recording->meet(v, pixel, sp);
    return true;
  }

  /// Begins the record of vertex `v`, which is stored in `region`.
  RELUME_HD void begin_vertex(uint32_t v, uint32_t region) {
    current = v;
    if (v >= recording->vertices) return;
    VertexSample sample;
    sample.region = region;
    recording->sample(v, pixel) = sample;
    factor[v] = 0;
    reached = v + 1;
  }

  template <typename Path>
  RELUME_HD void emitted(const Path& path, bool covered_by_nee) {
    const uint32_t v = path.bounce - 1;
    if (v < recording->vertices && covered_by_nee) radiance[v] = path.radiance;
  }

  template <typename Path, typename Connection>
  RELUME_HD void connected(const SurfacePoint&, const Path&, const Connection& connection, bool visible) {
    if (current < recording->vertices)
      recording->sample(current, pixel).light = connection.light | (visible ? kVisibleLight : 0u);
    if (visible) recording->offer(current, pixel, connection.light, luminance(connection.contribution));
  }

  template <typename Path>
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, const Path& path) {
    const uint32_t v = path.bounce - 1;
    if (v >= recording->vertices || path.delta) return;
    VertexSample& sample = recording->sample(v, pixel);
    sample.direction = pack_square(square_from_direction(path.ray.direction));
    sample.densities = pack_densities(path.pdf_w, s.guide_pdf_w);
    factor[v] = s.resampling * shading_cosine(sp, path.ray.direction) / path.pdf_w;
    if (s.bsdf_pdf_w > 0.0f && factor[v] > 0.0f && !has_delta(sp.bsdf))
      sample.bsdf = pack_densities(luminance(s.weight) / factor[v], s.bsdf_pdf_w);
    throughput[v] = path.throughput;
    // Directions count by the light in the image, so the recorded radiance keeps the weight of the wavelength.
    if (path.dispersed) throughput[v] /= wavelength_weight(path.wavelength_nm);
    radiance[v] = path.radiance;
  }

  template <typename Path>
  RELUME_HD void finished(const Path& path) {
    finish([&](uint32_t v) { return path.radiance - radiance[v]; });
  }

  /// Completes the records. `found_by(v)`: light in the image that the path found along the direction of vertex v.
  template <typename FoundBy>
  RELUME_HD void finish(const FoundBy& found_by) {
    for (uint32_t v = 0; v < recording->vertices; ++v) {
      VertexSample& out = recording->sample(v, pixel);
      if (v >= reached) {
        out = {};
      } else if (factor[v] > 0.0f) {
        out.value = value_of(v, found_by(v));
      }
    }
  }

 protected:
  /// Value of the light in the image that the path found along the direction of vertex v. The factor of the vertex must
  /// be positive.
  RELUME_HD float value_of(uint32_t v, const Rgb& found) const {
    Rgb incident(0);
    for (int c = 0; c < 3; ++c) {
      if (throughput[v][c] > 0.0f) incident[c] = found[c] / throughput[v][c];
    }
    return relume::max(luminance(incident) * factor[v], 0.0f);
  }

 private:
  RELUME_HD Vec3 random(uint32_t vertex) const {
    return RegionLookup::random_vector(hash(recording->lookup.seed, pixel, vertex));
  }
};

RELUME_HD inline PathRecorder PathRecording::begin(uint32_t pixel) const {
  PathRecorder recorder;
  recorder.recording = this;
  recorder.pixel = pixel;
  return recorder;
}

}  // namespace relume
