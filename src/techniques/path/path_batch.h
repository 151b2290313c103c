// How a host thread runs PathKernel: the paths of neighbouring pixels side by side, each step for all of them before
// the next. A processor then works on one path while it waits for another, which it cannot do along a single path, and
// shadow rays travel in packets. Steps, random numbers and results are those of trace_path.
#pragma once

#include "techniques/path/path.h"

namespace relume {

/// Paths that have all scattered equally often.
struct PathBatch {
  static constexpr uint32_t kSize = 32;  ///< few, so that what they touch stays in the first-level cache

  PathState paths[kSize];
  Sampler samplers[kSize];
  Hit hits[kSize];
  SurfacePoint points[2][kSize];  ///< this vertex and the previous one, in turn
  uint32_t active[kSize];         ///< paths that go on
  uint32_t count = 0;
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

/// Adds the contributions whose rays reach their light.
inline void add_visible(const AccelView& accel, const Ray* rays, const uint32_t* ids, const Rgb* contributions,
                        const uint32_t* owners, uint32_t count, PathBatch& b) {
  for (uint32_t first = 0; first < count; first += kPacketSize) {
    const int size = static_cast<int>(count - first < kPacketSize ? count - first : kPacketSize);
    bool blocked[kPacketSize];
    occluded_packet(accel, rays + first, ids + first, blocked, size);
    for (int k = 0; k < size; ++k) {
      if (!blocked[k]) b.paths[owners[first + k]].radiance += contributions[first + k];
    }
  }
}

/// Next event estimation for all active paths.
inline void connect_all(const PathContext& c, const SurfacePoint* points, PathBatch& b) {
  Ray rays[PathBatch::kSize];
  uint32_t ids[PathBatch::kSize];
  Rgb contributions[PathBatch::kSize];
  uint32_t owners[PathBatch::kSize];
  uint32_t count = 0;
  for (uint32_t k = 0; k < b.count; ++k) {
    const uint32_t i = b.active[k];
    const Connection connection = connect(c, points[i], b.paths[i], b.samplers[i]);
    rays[count] = connection.ray;
    ids[count] = connection.ray_id;
    contributions[count] = connection.contribution;
    owners[count] = i;
    if (!connection.valid()) continue;
    ++b.paths[i].rays;
    ++count;
  }
  add_visible(c.scene.accel, rays, ids, contributions, owners, count, b);
}

/// Follows all paths from their primary hits to their ends.
inline void trace(const PathContext& c, PathBatch& b) {
  for (uint32_t bounce = 0; b.count > 0; ++bounce) {
    SurfacePoint* points = b.points[bounce & 1u];
    const SurfacePoint* previous = b.points[(bounce & 1u) ^ 1u];
    filter(b, [&](uint32_t i) { return arrive(c, b.hits[i], previous[i], points[i], b.paths[i]); });
    connect_all(c, points, b);
    filter(b, [&](uint32_t i) { return continue_path(c, points[i], b.paths[i], b.samplers[i]); });
    for (uint32_t k = 0; k < b.count; ++k) {
      const uint32_t i = b.active[k];
      b.hits[i] = intersect(c.scene.accel, b.paths[i].ray, b.samplers[i].ray_id());
      ++b.paths[i].rays;
    }
  }
}

}  // namespace path_batch

inline void PathKernel::operator()(const Tile& tile) const {
  PathBatch b;
  uint32_t pixels[PathBatch::kSize];
  uint32_t x = tile.x0;
  uint32_t y = tile.y0;
  while (y < tile.y1) {
    uint32_t count = 0;
    while (count < PathBatch::kSize && y < tile.y1) {
      const uint32_t pixel = y * width + x;
      if (wanted(pixel)) {
        pixels[count] = pixel;
        b.active[count] = count;
        b.hits[count] = hits[pixel];
        b.samplers[count] = index.sampler(x, y);
        b.paths[count] = start_path(context, x, y, b.samplers[count]);
        ++count;
      } else {
        leave_out(pixel);
      }
      if (++x < tile.x1) continue;
      x = tile.x0;
      ++y;
    }
    b.count = count;
    path_batch::trace(context, b);
    for (uint32_t i = 0; i < count; ++i) {
      radiance[pixels[i]] = b.paths[i].radiance;
      rays[pixels[i]] = b.paths[i].rays;
    }
  }
}

}  // namespace relume
