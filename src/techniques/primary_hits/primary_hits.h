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
  uint32_t sample = 0;   ///< index within the sequence, or within the frame
  bool independent = false;  ///< a scramble of its own each frame

  RELUME_HD Sampler sampler(uint32_t x, uint32_t y) const {
    return independent ? Sampler::independent(seed, x, y, frame, sample) : Sampler::sequence(seed, x, y, sample);
  }
};

/// Camera ray through a random point of pixel (x, y); uses the first two dimensions.
RELUME_HD inline Ray camera_ray(const CameraView& camera, uint32_t x, uint32_t y, Sampler& sampler) {
  const Vec2 jitter = sampler.next_2d();
  const Vec2 u_lens = camera.lens_radius > 0.0f ? sampler.next_2d() : Vec2(0);
  return generate(camera, Vec2(static_cast<float>(x), static_cast<float>(y)) + jitter, u_lens);
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
    const Ray ray = camera_ray(camera, x, y, sampler);
    hits[y * width + x] = intersect(accel, ray, sampler.ray_id());
  }

  /// Packets of two rows.
  void operator()(const Tile& tile) const {
    for (uint32_t y = tile.y0; y < tile.y1; y += 2) {
      for (uint32_t x = tile.x0; x < tile.x1; x += kPacketSize / 2) packet(x, y, tile);
    }
  }

 private:
  void packet(uint32_t x0, uint32_t y0, const Tile& tile) const {
    Ray rays[kPacketSize];
    uint32_t ids[kPacketSize] = {};
    uint32_t pixels[kPacketSize];
    Hit found[kPacketSize];
    int count = 0;
    for (uint32_t y = y0; y < y0 + 2 && y < tile.y1; ++y) {
      for (uint32_t x = x0; x < x0 + kPacketSize / 2 && x < tile.x1; ++x) {
        Sampler sampler = index.sampler(x, y);
        rays[count] = camera_ray(camera, x, y, sampler);
        ids[count] = sampler.ray_id();
        pixels[count] = y * width + x;
        ++count;
      }
    }
    intersect_packet(accel, rays, ids, found, count, true);
    for (int i = 0; i < count; ++i) hits[pixels[i]] = found[i];
  }
};

/// Adds what the primary hit looks like to sums that are divided by the number of samples when shown. Views may be empty.
struct AuxiliaryKernel {
  SceneView scene;
  SampleIndex index;
  View<const Hit> hits;
  View<Rgb> albedo;     ///< directional albedo; the emission of emitters, clamped to 1; sky: 0
  View<Rgb> normal;     ///< shading normal, world space
  View<float> depth;    ///< distance from the camera, metres
  View<Vec2> motion;    ///< pixels from the previous frame's position to this one's
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Hit hit = hits[pixel];
    if (!hit.valid()) return;
    Sampler sampler = index.sampler(x, y);
    const Ray ray = camera_ray(scene.camera, x, y, sampler);
    SurfacePoint sp;
    make_surface_point(scene, ray, hit, scene.camera.cone_width() + scene.camera.cone_spread() * hit.t, sp);
    if (!albedo.empty()) albedo[pixel] += glm::min(relume::albedo(sp.bsdf, glm::dot(sp.wo, sp.frame.n)) + sp.emission, Rgb(1));
    if (!normal.empty()) normal[pixel] += sp.frame.n;
    if (!depth.empty()) depth[pixel] += hit.t;
    if (!motion.empty()) motion[pixel] += motion_of(sp);
  }

 private:
  RELUME_HD Vec2 motion_of(const SurfacePoint& sp) const {
    Vec2 now;
    Vec2 before;
    const auto ray_to = [](const CameraView& camera, const Vec3& p) {
      const Vec3 along = camera.projection == Projection::orthographic ? -camera.axes.n : glm::normalize(p - camera.position);
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
