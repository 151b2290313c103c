// The first vertex of every path: camera rays, traced in coherent packets, and what auxiliary buffers show of it.
#pragma once

#include "backend/launch.h"
#include "sampling/sampler.h"
#include "scene/surface_point.h"

namespace relume {

/// Which sample of which pixel is being taken.
struct SampleIndex {
  uint32_t seed = 0;
  uint32_t frame = 0;
  uint32_t sample = 0;       ///< index within the sequence, or within the frame
  bool independent = false;  ///< a scramble of its own each frame

  RELUME_HD uint32_t scramble_frame() const { return independent ? frame : Sampler::kAllFrames; }
  RELUME_HD_INLINE Sampler sampler(uint32_t x, uint32_t y) const {
    return Sampler::independent(seed, x, y, scramble_frame(), sample);
  }
};

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

/// Finds the primary hit of every pixel.
struct PrimaryHitsKernel {
  AccelView accel;
  CameraView camera;
  SampleIndex index;
  View<Hit> hits;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    Sampler sampler = index.sampler(x, y);
    const Ray ray = lone_camera_ray(camera, x, y, sampler);
    hits[y * width + x] = intersect(accel, ray, sampler.camera_ray_id());
  }

  /// Packets of two rows.
  void operator()(const Tile& tile) const {
    for (uint32_t y = tile.y0; y < tile.y1; y += 2) {
      for (uint32_t x = tile.x0; x < tile.x1; x += kPacketSize / 2) packet(x, y, tile);
    }
  }

 private:
  void packet(uint32_t x0, uint32_t y0, const Tile& tile) const {
    constexpr uint32_t kColumns = kPacketSize / 2;
    float jitter_x[kPacketSize];
    float jitter_y[kPacketSize];
    uint32_t ids[kPacketSize];
    // All lanes, inside the tile or not, and nothing but hashes: becomes vector code.
    const uint32_t frame = index.scramble_frame();
    for (uint32_t k = 0; k < kPacketSize; ++k) {
      const Sampler sampler =
          Sampler::independent(index.seed, x0 + k % kColumns, y0 + k / kColumns, frame, index.sample);
      const Vec2 u = sampler.first_2d();
      jitter_x[k] = u.x;
      jitter_y[k] = u.y;
      ids[k] = sampler.camera_ray_id();
    }
    Ray rays[kPacketSize];
    uint32_t pixels[kPacketSize];
    Hit found[kPacketSize];
    int count = 0;
    for (uint32_t k = 0; k < kPacketSize; ++k) {
      const uint32_t x = x0 + k % kColumns;
      const uint32_t y = y0 + k / kColumns;
      if (x >= tile.x1 || y >= tile.y1) continue;
      if (camera.lens_radius > 0.0f) {
        Sampler sampler = index.sampler(x, y);
        rays[count] = camera_ray(camera, x, y, sampler);
      } else {
        rays[count] = pinhole_camera_ray(camera, x, y, {jitter_x[k], jitter_y[k]});
      }
      ids[count] = ids[k];
      pixels[count] = y * width + x;
      ++count;
    }
    intersect_packet(accel, rays, ids, found, count, true);
    for (int i = 0; i < count; ++i) hits[pixels[i]] = found[i];
  }
};

/// Adds what the primary hit looks like to sums that are divided by the number of samples when shown. Views may be
/// empty.
struct AuxiliaryKernel {
  SceneView scene;
  SampleIndex index;
  View<const Hit> hits;
  View<Rgb> albedo;   ///< directional albedo; the emission of emitters, clamped to 1; sky: 0
  View<Rgb> normal;   ///< shading normal, world space
  View<float> depth;  ///< distance from the camera, metres
  View<Vec2> motion;  ///< pixels from the previous frame's position to this one's
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Hit hit = hits[pixel];
    if (!hit.valid()) return;
    Sampler sampler = index.sampler(x, y);
    const Ray ray = lone_camera_ray(scene.camera, x, y, sampler);
    SurfacePoint sp;
    make_surface_point(scene, ray, hit, scene.camera.cone_width() + scene.camera.cone_spread() * hit.t, sp);
    if (!albedo.empty())
      albedo[pixel] += glm::min(relume::albedo(sp.bsdf, glm::dot(sp.wo, sp.frame.n)) + sp.emission, Rgb(1));
    if (!normal.empty()) normal[pixel] += sp.frame.n;
    if (!depth.empty()) depth[pixel] += hit.t;
    if (!motion.empty()) motion[pixel] += motion_of(sp);
  }

 private:
  RELUME_HD Vec2 motion_of(const SurfacePoint& sp) const {
    Vec2 now(0);
    Vec2 before(0);
    const auto ray_to = [](const CameraView& camera, const Vec3& p) {
      const Vec3 along =
          camera.projection == Projection::orthographic ? -camera.axes.n : glm::normalize(p - camera.position);
      const Vec3 origin = camera.projection == Projection::orthographic ? p : camera.position;
      return Ray{origin, along, kInfinity};
    };
    film_position(scene.camera, ray_to(scene.camera, sp.position), &now);
    film_position(scene.previous_camera, ray_to(scene.previous_camera, sp.previous_position), &before);
    const Vec2 difference = now - before;
    return is_finite(difference.x) && is_finite(difference.y) ? difference : Vec2(0);
  }
};

}  // namespace relume
