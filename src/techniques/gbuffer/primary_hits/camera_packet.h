// Camera rays of single pixels, and of packets of neighbouring pixels.
#pragma once

#include "frame/launch.h"
#include "sampling/sample_index.h"
#include "scene/scene_view.h"

namespace relume {

/// Camera ray through the point `jitter` of pixel (x, y), without a lens.
RELUME_HD_INLINE Ray pinhole_camera_ray(const CameraView& camera, uint32_t x, uint32_t y, const Vec2& jitter) {
  return generate(camera, Vec2(static_cast<float>(x), static_cast<float>(y)) + jitter, Vec2(0));
}

/// Time of a sample's path within the shutter; the middle if it is closed.
RELUME_HD_INLINE float shutter_time(const CameraView& camera, const Sampler& sampler) {
  if (!camera.shutter_open) return kShutterMiddle;
  return camera.frame_time >= 0.0f ? camera.frame_time : sampler.shutter_number();
}

/// Camera ray of an open shutter through the point `jitter` of pixel (x, y).
RELUME_HD inline Ray timed_camera_ray(const CameraView& camera, uint32_t x, uint32_t y, const Vec2& jitter,
                                      const Vec2& u_lens, float time) {
  Ray ray = generate(camera_at(camera, time), Vec2(static_cast<float>(x), static_cast<float>(y)) + jitter, u_lens);
  ray.time = time;
  return ray;
}

/// Camera ray through a random point of pixel (x, y); uses the first two dimensions.
RELUME_HD inline Ray camera_ray(const CameraView& camera, uint32_t x, uint32_t y, Sampler& sampler) {
  const Vec2 jitter = sampler.next_2d();
  const Vec2 u_lens = sampler.next_2d();
  if (camera.shutter_open) return timed_camera_ray(camera, x, y, jitter, u_lens, shutter_time(camera, sampler));
  return generate(camera, Vec2(static_cast<float>(x), static_cast<float>(y)) + jitter, u_lens);
}

/// The same ray, for callers that draw nothing else from the sampler.
RELUME_HD inline Ray lone_camera_ray(const CameraView& camera, uint32_t x, uint32_t y, Sampler& sampler) {
  if (camera.lens_radius > 0.0f) return camera_ray(camera, x, y, sampler);
  if (camera.shutter_open)
    return timed_camera_ray(camera, x, y, sampler.first_2d(), Vec2(0), shutter_time(camera, sampler));
  return pinhole_camera_ray(camera, x, y, sampler.first_2d());
}

/// lone_camera_ray() of up to kPacketSize pixels, with the same bits. Host only.
struct CameraPacket {
  static constexpr uint32_t kColumns = kPacketSize / 2;

  uint32_t x[kPacketSize];
  uint32_t y[kPacketSize];
  int count = 0;
  Ray rays[kPacketSize];
  uint32_t ids[kPacketSize];  ///< Sampler::camera_ray_id()

  /// Adds a pixel. Returns true if the packet is full.
  bool add(uint32_t column, uint32_t row) {
    x[count] = column;
    y[count] = row;
    return ++count == kPacketSize;
  }
  /// Takes kColumns pixels of two rows from (x0, y0) on, clipped to `tile`.
  void take_rows(uint32_t x0, uint32_t y0, const Tile& tile) {
    count = 0;
    for (uint32_t row = y0; row < relume::min(y0 + 2, tile.y1); ++row) {
      for (uint32_t column = x0; column < relume::min(x0 + kColumns, tile.x1); ++column) add(column, row);
    }
  }
  /// Computes the rays of at least one pixel.
  void generate(const CameraView& camera, const SampleIndex& index) {
    float raster_x[kPacketSize];
    float raster_y[kPacketSize];
    draw(index, raster_x, raster_y);
    const bool plain = !(camera.lens_radius > 0.0f) && !camera.shutter_open;
    if (camera.projection == Projection::perspective && plain) {
      Directions directions;
      directions.fill(camera, raster_x, raster_y);
      for (int k = 0; k < count; ++k)
        rays[k] = {camera.position, {directions.x[k], directions.y[k], directions.z[k]}, kInfinity};
      return;
    }
    for (int k = 0; k < count; ++k) {
      Sampler sampler = index.sampler(x[k], y[k]);
      rays[k] = lone_camera_ray(camera, x[k], y[k], sampler);
    }
  }

 private:
  /// Draws raster positions and ids.
  void draw(const SampleIndex& index, float (&raster_x)[kPacketSize], float (&raster_y)[kPacketSize]) {
    const auto draw_each = [&](int lanes, const auto& sampler_of) {
      for (int k = 0; k < lanes; ++k) {
        const Sampler sampler = sampler_of(k);
        const Vec2 u = sampler.first_2d();
        raster_x[k] = static_cast<float>(x[k]) + u.x;
        raster_y[k] = static_cast<float>(y[k]) + u.y;
        ids[k] = sampler.camera_ray_id();
      }
    };
    if (!index.is_plain()) return draw_each(count, [&](int k) { return index.sampler(x[k], y[k]); });
    // Fills all lanes and computes only hashes, so that the loop vectorises.
    uint32_t elements[kPacketSize];
    for (int k = 0; k < count; ++k) elements[k] = index.sample_of(x[k], y[k]);
    for (int k = count; k < kPacketSize; ++k) {
      x[k] = x[0];
      y[k] = y[0];
      elements[k] = elements[0];
    }
    draw_each(kPacketSize,
              [&](int k) { return Sampler::sequence(index.seed, x[k], y[k], elements[k], index.sequence); });
  }

  /// Directions of a perspective camera without a lens, as generate() computes them, for all lanes at once.
  struct Directions {
    float x[kPacketSize];
    float y[kPacketSize];
    float z[kPacketSize];

    void fill(const CameraView& camera, const float (&raster_x)[kPacketSize], const float (&raster_y)[kPacketSize]) {
      const Frame axes = camera.axes;
      const Vec2 resolution = camera.resolution;
      const Vec2 half = camera.half_extent;
      for (uint32_t k = 0; k < kPacketSize; ++k) {
        const float right = (2.0f * raster_x[k] / resolution.x - 1.0f) * half.x;
        const float up = (1.0f - 2.0f * raster_y[k] / resolution.y) * half.y;
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
