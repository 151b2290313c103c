// The first vertex of every path: camera rays, traced in coherent packets, and what auxiliary buffers show of it.
#pragma once

#include "backend/launch.h"
#include "sampling/sample_index.h"
#include "scene/surface_point.h"

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

/// No surface: the camera ray left the scene.
inline constexpr uint32_t kNoSurface = 0xffffffffu;

/// Ray of a pinhole camera towards a point.
RELUME_HD inline Ray ray_to(const CameraView& camera, const Vec3& p) {
  if (camera.projection == Projection::orthographic) return {p, -camera.axes.n, kInfinity};
  return {camera.position, glm::normalize(p - camera.position), kInfinity};
}

/// Pixels from where `before` met the previous frame's film to where `now` meets this one's; zero if one of them did
/// not.
RELUME_HD inline Vec2 film_motion(const SceneView& scene, const Ray& now, const Ray& before) {
  Vec2 here(kInfinity);  // stays so behind the camera
  Vec2 there(kInfinity);
  film_position(scene.camera, now, &here);
  film_position(scene.previous_camera, before, &there);
  const Vec2 difference = here - there;
  return is_finite(difference.x) && is_finite(difference.y) ? difference : Vec2(0);
}

/// What the primary hit shows, for filters, histories and auxiliary outputs. Pixels that see no surface get zeros,
/// kNoSurface and the motion of infinity.
struct SurfaceKernel {
  SceneView scene;
  SampleIndex index;
  View<const Hit> hits;
  View<Vec3> position;     ///< metres, world space
  View<Vec3> previous;     ///< where that point was one frame ago
  View<Vec3> normal;       ///< shading normal, world space
  View<Rgb> albedo;        ///< directional albedo; the emission of emitters, clamped to 1
  View<float> depth;       ///< distance from the camera, metres
  View<Vec2> motion;       ///< pixels from the previous frame's position to this one's
  View<uint32_t> surface;  ///< instance
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Hit hit = hits[pixel];
    Sampler sampler = index.sampler(x, y);
    const Ray ray = lone_camera_ray(scene.camera, x, y, sampler);
    surface[pixel] = hit.instance;
    if (!hit.valid()) {
      position[pixel] = previous[pixel] = normal[pixel] = Vec3(0);
      albedo[pixel] = Rgb(0);
      depth[pixel] = 0.0f;
      motion[pixel] = film_motion(scene, ray, Ray{scene.previous_camera.position, ray.direction, kInfinity});
      return;
    }
    SurfacePoint sp;
    make_surface_point(scene, ray, hit, scene.camera.cone_width() + scene.camera.cone_spread() * hit.t, sp);
    position[pixel] = sp.position;
    previous[pixel] = sp.previous_position;
    normal[pixel] = sp.frame.n;
    albedo[pixel] = glm::min(relume::albedo(sp.bsdf, glm::dot(sp.wo, sp.frame.n)) + sp.emission, Rgb(1));
    depth[pixel] = hit.t;
    motion[pixel] =
        film_motion(scene, ray_to(scene.camera, sp.position), ray_to(scene.previous_camera, sp.previous_position));
  }
};

/// Sums of what the primary hits of several samples show; divided by their number when written. Motion is that of the
/// first, as nothing moves while samples of a still picture add up.
struct AuxiliaryKernel {
  View<const Rgb> surface_albedo;
  View<const Vec3> surface_normal;
  View<const float> surface_depth;
  View<const Vec2> surface_motion;
  View<Rgb> albedo;
  View<Vec3> normal;
  View<float> depth;
  View<Vec2> motion;
  bool first = false;  ///< sample after a change: the only one that shows motion
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    albedo[pixel] += surface_albedo[pixel];
    normal[pixel] += surface_normal[pixel];
    depth[pixel] += surface_depth[pixel];
    if (first) motion[pixel] = surface_motion[pixel];
  }
};

}  // namespace relume
