// Watches paths and writes the records of their first vertices.
#pragma once

#include "core/hash.h"
#include "core/octahedral.h"
#include "scene/surface_point.h"
#include "techniques/octree/sample_stream.h"

namespace relume {

/// Observes one path (techniques/path/path.h says what the calls mean). Radiance found along a direction is what the
/// path's radiance grew by after it was chosen, over the throughput then, but for emission that next event estimation
/// knows.
struct PathRecorder {
  OctreeView octree;
  View<VertexSample> samples;
  uint32_t vertices = 0;
  uint32_t pixels = 0;
  uint32_t pixel = 0;
  float jitter = 0;
  uint32_t seed = 0;
  uint32_t current = 0;  ///< vertex
  uint32_t reached = 0;  ///< vertices so far, up to `vertices`
  VertexSample records[kMaxRecordedVertices];
  Rgb throughput[kMaxRecordedVertices];  ///< when the path went on
  Rgb radiance[kMaxRecordedVertices];
  float factor[kMaxRecordedVertices];  ///< cos θ / pdf_w; 0: no direction

  template <typename Path>
  RELUME_HD bool arrived(SurfacePoint& sp, const Path& path) {
    const RegionPair regions = octree.find_pair(sp.previous_position, sp.position);
    const uint32_t v = path.bounce;
    sp.region =
        jitter > 0.0f ? octree.find_near(octree.quantise(sp.previous_position), jitter, random(v)) : regions.sample;
    current = v;
    if (v >= vertices) return true;
    records[v] = {};
    records[v].region = regions.store;
    factor[v] = 0;
    reached = v + 1;
    return true;
  }

  template <typename Path>
  RELUME_HD void emitted(const Path& path, bool lights_know) {
    const uint32_t v = path.bounce - 1;
    if (v < vertices && lights_know) radiance[v] = path.radiance;
  }

  template <typename Path, typename Connection>
  RELUME_HD void connected(const SurfacePoint&, const Path&, const Connection& connection, bool visible) {
    if (current < vertices) records[current].light = connection.light | (visible ? kVisibleLight : 0u);
  }

  template <typename Path>
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample&, const Path& path) {
    const uint32_t v = path.bounce - 1;
    if (v >= vertices || path.delta) return;
    records[v].direction = pack_square(square_from_direction(path.ray.direction));
    factor[v] = shading_cosine(sp, path.ray.direction) / path.pdf_w;
    throughput[v] = path.throughput;
    radiance[v] = path.radiance;
  }

  template <typename Path>
  RELUME_HD void finished(const Path& path) {
    for (uint32_t v = 0; v < vertices; ++v) {
      VertexSample& out = samples[v * pixels + pixel];
      out = {};
      if (v >= reached) continue;
      out = records[v];
      if (!(factor[v] > 0.0f)) continue;
      const Rgb found = path.radiance - radiance[v];
      Rgb incident(0);
      for (int c = 0; c < 3; ++c) {
        if (throughput[v][c] > 0.0f) incident[c] = found[c] / throughput[v][c];
      }
      out.value = relume::max(luminance(incident) * factor[v], 0.0f);
    }
  }

 private:
  RELUME_HD Vec3 random(uint32_t vertex) const {
    const uint32_t h = hash(seed, pixel, vertex);
    return {to_unit_float(h), to_unit_float(hash(h, 1u)), to_unit_float(hash(h, 2u))};
  }
};

/// Makes recorders.
struct PathRecording {
  OctreeView octree;
  View<VertexSample> samples;
  uint32_t vertices = 0;
  uint32_t pixels = 0;
  float jitter = 0;   ///< of places that samples are taken from, in edges of leaves
  uint32_t seed = 0;  ///< of that; differs from frame to frame

  RELUME_HD PathRecorder begin(uint32_t pixel) const {
    PathRecorder recorder{};
    recorder.octree = octree;
    recorder.samples = samples;
    recorder.vertices = vertices;
    recorder.pixels = pixels;
    recorder.pixel = pixel;
    recorder.jitter = jitter;
    recorder.seed = seed;
    return recorder;
  }
  /// Nothing from this pixel.
  RELUME_HD void skip(uint32_t pixel) const {
    for (uint32_t v = 0; v < vertices; ++v) samples[v * pixels + pixel] = {};
  }
};

}  // namespace relume
