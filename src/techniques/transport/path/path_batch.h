// Host execution of kernels that trace one path per pixel. A batch runs the paths of neighbouring pixels side by side,
// one step for all of them before the next. The processor then works on one path while another waits for memory, lights
// are sampled eight at once, and rays travel in packets. Steps, random numbers and results are those of trace_path().
#pragma once

#include "lights/sample_lights.h"
#include "scene/prefetch.h"
#include "techniques/gbuffer/primary_hits/first_surfaces.h"
#include "techniques/transport/path/resampled_light.h"

namespace relume {

/// Paths with equal numbers of bounces, and their connections to lights.
struct PathBatch {
  static constexpr uint32_t kSize = 64;  ///< four packets

  PathState paths[kSize];
  Sampler samplers[kSize];
  Hit hits[kSize];
  SurfacePoint points[2][kSize];  ///< current and previous vertex, alternating
  uint32_t active[kSize];         ///< paths that continue
  uint32_t count = 0;

  LightPick picks[kSize];
  LightRequest requests[kSize];
  LightSample samples[kSize];  ///< of the picked lights
  Connection connections[kSize];
  uint32_t owners[kSize];  ///< path of each pick, then of each connection, in ascending order
  uint32_t connection_count = 0;
};

namespace path_batch {

/// Keeps the active paths for which `step` returns true.
template <typename Step>
inline void filter(PathBatch& b, const Step& step) {
  uint32_t kept = 0;
  for (uint32_t k = 0; k < b.count; ++k) {
    const uint32_t i = b.active[k];
    b.active[kept] = i;
    if (step(i)) ++kept;
  }
  b.count = kept;
}

/// Adds the contributions of connections that are not blocked.
template <typename Policy>
inline void add_visible(const AccelView& accel, const SurfacePoint* points, PathBatch& b, Policy* policies) {
  for (uint32_t first = 0; first < b.connection_count; first += kPacketSize) {
    const uint32_t left = b.connection_count - first;
    const int size = static_cast<int>(left < kPacketSize ? left : kPacketSize);
    Ray rays[kPacketSize];
    uint32_t ids[kPacketSize];
    bool blocked[kPacketSize];
    for (int k = 0; k < size; ++k) {
      rays[k] = b.connections[first + k].ray;
      ids[k] = b.connections[first + k].ray_id;
    }
    occluded_packet(accel, rays, ids, blocked, size);
    for (int k = 0; k < size; ++k) {
      const Connection& connection = b.connections[first + k];
      const uint32_t i = b.owners[first + k];
      if (!blocked[k]) b.paths[i].radiance += connection.contribution;
      policies[i].connected(points[i], b.paths[i], connection, !blocked[k]);
    }
  }
}

/// Nearest hits of the rays of all active paths.
inline void intersect_all(const PathContext& c, PathBatch& b) {
  for (uint32_t first = 0; first < b.count; first += kPacketSize) {
    const int size = static_cast<int>(relume::min(b.count - first, static_cast<uint32_t>(kPacketSize)));
    Ray rays[kPacketSize];
    uint32_t ids[kPacketSize];
    Hit hits[kPacketSize];
    for (int k = 0; k < size; ++k) {
      const uint32_t i = b.active[first + k];
      rays[k] = b.paths[i].ray;
      ids[k] = ray_id_of(c, b.paths[i], b.samplers[i]);
      ++b.paths[i].rays;
    }
    intersect_packet(c.scene.accel, rays, ids, hits, size);
    for (int k = 0; k < size; ++k) b.hits[b.active[first + k]] = hits[k];
  }
}

/// Next event estimation for all active paths.
template <typename Policy>
inline void connect_all(const PathContext& c, const SurfacePoint* points, PathBatch& b, Policy* policies) {
  uint32_t count = 0;
  for (uint32_t k = 0; k < b.count; ++k) {
    const uint32_t i = b.active[k];
    const LightPick pick = b.picks[count] = pick_light_for<Policy>(c, points[i], b.paths[i], b.samplers[i]);
    if (!(pick.pmf > 0.0f)) continue;
    path_policy::light_picked(policies[i], points[i], b.paths[i], pick.id);
    b.requests[count] = {pick.id, points[i].position, pick.u, points[i].time};
    b.owners[count++] = i;
  }
  sample_lights(c.scene.lights, {b.requests, count}, b.samples);
  b.connection_count = 0;
  for (uint32_t k = 0; k < count; ++k) {
    const uint32_t i = b.owners[k];
    Connection& connection = b.connections[b.connection_count];
    if (!make_connection(c, points[i], b.paths[i], b.picks[k], b.samples[k], b.samplers[i], connection)) continue;
    b.owners[b.connection_count++] = i;
    ++b.paths[i].rays;
  }
  add_visible(c.scene.accel, points, b, policies);
}

/// Traces all paths from their primary hits to their ends, with one policy per path. `first_arrived()` is called when
/// every path has arrived at its primary hit.
template <typename Policy, typename FirstArrived>
inline void trace(const PathContext& c, PathBatch& b, Policy* policies, const FirstArrived& first_arrived) {
  for (uint32_t bounce = 0; b.count > 0; ++bounce) {
    SurfacePoint* points = b.points[bounce & 1u];
    const SurfacePoint* previous = b.points[(bounce & 1u) ^ 1u];
    prefetch_surfaces(c.scene, b.hits, b.active, b.count);
    filter(b, [&](uint32_t i) { return arrive(c, b.hits[i], previous[i], points[i], b.paths[i], policies[i]); });
    if (bounce == 0) first_arrived();
    if constexpr (DecidesLater<Policy>) filter(b, [&](uint32_t i) { return policies[i].goes_on(b.paths[i]); });
    connect_all(c, points, b, policies);
    filter(b, [&](uint32_t i) {
      const BsdfSample s = c.directions.sample(points[i], b.samplers[i]);
      if (!follow(c, points[i], s, b.paths[i], b.samplers[i])) return false;
      policies[i].scattered(points[i], s, b.paths[i]);
      return true;
    });
    intersect_all(c, b);
  }
}

/// PathKernel for a tile. `first_surfaces`: receives the surfaces at the primary hits; nullptr: no pass needs them.
/// Policies must not change the lobes of these surfaces.
template <typename Kernel>
inline void trace_tile(const Kernel& kernel, const Tile& tile, const FirstSurfaces* first_surfaces) {
  using Policies = decltype(kernel.policies(0u, 0u));
  PathBatch b;
  Policies policies[PathBatch::kSize];
  uint32_t pixels[PathBatch::kSize];
  uint32_t x = tile.x0;
  uint32_t y = tile.y0;
  while (y < tile.y1) {
    uint32_t count = 0;
    while (count < PathBatch::kSize && y < tile.y1) {
      const uint32_t pixel = y * kernel.width + x;
      if (kernel.wanted(pixel)) {
        pixels[count] = pixel;
        b.active[count] = count;
        b.hits[count] = kernel.hits[pixel];
        b.samplers[count] = kernel.index.sampler(x, y);
        b.paths[count] = start_path(kernel.context, x, y, b.samplers[count]);
        policies[count] = kernel.policies(x, y);
        ++count;
      } else {
        kernel.leave_out(pixel);
      }
      if (++x < tile.x1) continue;
      x = tile.x0;
      ++y;
    }
    b.count = count;
    trace(kernel.context, b, policies, [&] {
      if (!first_surfaces) return;
      for (uint32_t i = 0; i < count; ++i)
        first_surfaces->receive(pixels[i], b.paths[i].ray, b.samplers[i].camera_ray_id(), b.hits[i], b.points[0][i]);
    });
    for (uint32_t i = 0; i < count; ++i) {
      policies[i].finished(b.paths[i]);
      kernel.finish(pixels[i], policies[i], b.paths[i]);
    }
  }
}

}  // namespace path_batch

}  // namespace relume
