// Camera rays of neighbouring pixels, computed side by side. Host only.
#pragma once

#include "backend/launch.h"
#include "sampling/sample_index.h"
#include "scene/scene_view.h"

namespace relume {

/// Camera ray through the point `jitter` of pixel (x, y), without a lens.
RELUME_HD_INLINE Ray pinhole_camera_ray(const CameraView& camera, uint32_t x, uint32_t y, const Vec2& jitter) {
  return generate(camera, Vec2(static_cast<float>(x), static_cast<float>(y)) + jitter, Vec2(0));
}

/// Camera ray through a random point of pixel (x, y); uses the first two dimensions.
RELUME_HD inline Ray camera_ray(const CameraView& camera, uint32_t x, uint32_t y, Sampler& sampler) {
  const Vec2 jitter = sampler.next_2d();
  const Vec2 u_lens = sampler.next_2d();
  return generate(camera, Vec2(static_cast<float>(x), static_cast<float>(y)) + jitter, u_lens);
}

/// The same ray where nothing else will be drawn from the sampler.
RELUME_HD inline Ray lone_camera_ray(const CameraView& camera, uint32_t x, uint32_t y, Sampler& sampler) {
  if (camera.lens_radius > 0.0f) return camera_ray(camera, x, y, sampler);
  return pinhole_camera_ray(camera, x, y, sampler.first_2d());
}

/// lone_camera_ray() of kPacketSize pixels in two rows, to the bit.
struct CameraPacket {
  static constexpr uint32_t kColumns = kPacketSize / 2;

  Ray rays[kPacketSize];
  uint32_t ids[kPacketSize];  ///< Sampler::camera_ray_id()
  uint32_t x[kPacketSize];
  uint32_t y[kPacketSize];
  int count = 0;

  /// Of the pixels from (x0, y0) on that lie in `tile`.
  void fill(const CameraView& camera, const SampleIndex& index, uint32_t x0, uint32_t y0, const Tile& tile) {
    float film_x[kPacketSize];
    float film_y[kPacketSize];
    uint32_t all_ids[kPacketSize];
    const auto draw = [&](const auto& sampler_of) {
      for (uint32_t k = 0; k < kPacketSize; ++k) {
        const uint32_t column = x0 + k % kColumns;
        const uint32_t row = y0 + k / kColumns;
        const Sampler sampler = sampler_of(column, row);
        const Vec2 u = sampler.first_2d();
        film_x[k] = static_cast<float>(column) + u.x;
        film_y[k] = static_cast<float>(row) + u.y;
        all_ids[k] = sampler.camera_ray_id();
      }
    };
    if (index.is_plain()) {
      // All lanes, inside the tile or not, and nothing but hashes: becomes vector code.
      draw([&](uint32_t column, uint32_t row) {
        return Sampler::sequence(index.seed, column, row, index.sample, index.sequence);
      });
    } else {
      draw([&](uint32_t column, uint32_t row) {
        return index.sampler(relume::min(column, tile.x1 - 1), relume::min(row, tile.y1 - 1));
      });
    }
    Directions directions;
    const bool pinhole = camera.projection == Projection::perspective && !(camera.lens_radius > 0.0f);
    if (pinhole) directions.fill(camera, film_x, film_y);
    count = 0;
    for (uint32_t k = 0; k < kPacketSize; ++k) {
      const uint32_t column = x0 + k % kColumns;
      const uint32_t row = y0 + k / kColumns;
      if (column >= tile.x1 || row >= tile.y1) continue;
      if (pinhole) {
        rays[count] = {camera.position, {directions.x[k], directions.y[k], directions.z[k]}, kInfinity};
      } else {
        Sampler sampler = index.sampler(column, row);
        rays[count] = lone_camera_ray(camera, column, row, sampler);
      }
      ids[count] = all_ids[k];
      x[count] = column;
      y[count] = row;
      ++count;
    }
  }

  /// Adds the ray of one pixel. True if the packet is full.
  bool add(const CameraView& camera, const SampleIndex& index, uint32_t column, uint32_t row) {
    Sampler sampler = index.sampler(column, row);
    rays[count] = lone_camera_ray(camera, column, row, sampler);
    ids[count] = sampler.camera_ray_id();
    x[count] = column;
    y[count] = row;
    return ++count == kPacketSize;
  }

 private:
  /// Of a perspective camera without a lens: what generate() computes, for all film positions at once.
  struct Directions {
    float x[kPacketSize];
    float y[kPacketSize];
    float z[kPacketSize];

    void fill(const CameraView& camera, const float (&film_x)[kPacketSize], const float (&film_y)[kPacketSize]) {
      const Frame axes = camera.axes;
      const Vec2 resolution = camera.resolution;
      const Vec2 half = camera.half_extent;
      for (uint32_t k = 0; k < kPacketSize; ++k) {
        const float right = (2.0f * film_x[k] / resolution.x - 1.0f) * half.x;
        const float up = (1.0f - 2.0f * film_y[k] / resolution.y) * half.y;
        const float wx = right * axes.t.x + up * axes.b.x - axes.n.x;
        const float wy = right * axes.t.y + up * axes.b.y - axes.n.y;
        const float wz = right * axes.t.z + up * axes.b.z - axes.n.z;
        const float scale = 1.0f / std::sqrt(wx * wx + wy * wy + wz * wz);
        x[k] = wx * scale;
        y[k] = wy * scale;
        z[k] = wz * scale;
      }
    }
  };
};

}  // namespace relume
