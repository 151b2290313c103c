// The first vertex of every path: traces camera rays and writes the surface properties of hits.
#pragma once

#include "scene/ray_queries.h"
#include "scene/surface_point.h"
#include "techniques/gbuffer/primary_hits/camera_packet.h"

namespace relume {

/// Traces the camera rays of pixels that receive a sample; other pixels get no hit.
struct PrimaryHitsKernel {
  SceneView scene;
  SampleIndex index;
  View<Hit> hits;
  View<const uint32_t> allocation;  ///< samples of each pixel, 0 or 1; empty: 1
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    if (!wanted(x, y)) {
      hits[y * width + x] = {};
      return;
    }
    Sampler sampler = index.sampler(x, y);
    const Ray ray = lone_camera_ray(scene.camera, x, y, sampler);
    hits[y * width + x] = intersect_from_camera(scene, ray, sampler.camera_ray_id());
  }

  /// Traces packets of two rows, or of the pixels that receive a sample.
  void operator()(const Tile& tile) const {
    if (!allocation.empty()) return trace_samples(tile);
    for (uint32_t y = tile.y0; y < tile.y1; y += 2) {
      for (uint32_t x = tile.x0; x < tile.x1; x += CameraPacket::kColumns) {
        CameraPacket packet;
        packet.take_rows(x, y, tile);
        trace(packet);
      }
    }
  }

 private:
  void trace_samples(const Tile& tile) const {
    CameraPacket packet;
    for (uint32_t y = tile.y0; y < tile.y1; ++y) {
      for (uint32_t x = tile.x0; x < tile.x1; ++x) {
        if (!wanted(x, y)) {
          hits[y * width + x] = {};
        } else if (packet.add(x, y)) {
          trace(packet);
          packet.count = 0;
        }
      }
    }
    trace(packet);
  }
  void trace(CameraPacket& packet) const {
    if (packet.count == 0) return;
    packet.generate(scene.camera, index);
    Hit found[kPacketSize];
    intersect_packet_from_camera(scene.accel, packet.rays, packet.ids, found, packet.count);
    for (int i = 0; i < packet.count; ++i) hits[packet.y[i] * width + packet.x[i]] = found[i];
  }
  RELUME_HD bool wanted(uint32_t x, uint32_t y) const { return allocation.empty() || allocation[y * width + x] != 0; }
};

/// Projects `p` to the image plane, through the centre of the lens. Returns false if it lies behind the camera.
RELUME_HD inline bool raster_position_of(const CameraView& camera, const Vec3& p, Vec2* raster) {
  if (camera.projection == Projection::perspective) {
    const Vec3 local = camera.axes.to_local(p - camera.position);
    if (local.z >= 0.0f) return false;
    const float scale = -1.0f / local.z;
    *raster = camera_detail::raster_from_ndc(camera, Vec2(local) * scale / camera.half_extent);
    return true;
  }
  raster->x = kInfinity;
  const bool orthographic = camera.projection == Projection::orthographic;
  raster_position(camera,
                  orthographic ? Ray{p, -camera.axes.n, kInfinity}
                               : Ray{camera.position, glm::normalize(p - camera.position), kInfinity},
                  raster);
  return is_finite(raster->x);
}

/// Motion of points behind a camera, pixels. The largest binary16, outside every image.
inline constexpr float kFromNowhere = 65504;

/// Motion in pixels from `before` in the previous frame to `now` in this one; kFromNowhere if either lies behind its
/// camera.
RELUME_HD inline Vec2 raster_motion(const SceneView& scene, const Vec3& now, const Vec3& before) {
  Vec2 here;
  Vec2 there;
  if (!raster_position_of(scene.camera, now, &here) || !raster_position_of(scene.previous_camera, before, &there))
    return Vec2(kFromNowhere);
  const Vec2 difference = here - there;
  return is_finite(difference.x) && is_finite(difference.y) ? difference : Vec2(kFromNowhere);
}

/// Motion of a point at infinity in this direction.
RELUME_HD inline Vec2 raster_motion_of_direction(const SceneView& scene, const Vec3& direction) {
  if (scene.camera.projection == Projection::orthographic) return Vec2(0);
  return raster_motion(scene, scene.camera.position + direction, scene.previous_camera.position + direction);
}

/// Writes the surface properties of primary hits. Pixels without a hit get zeros, kNoSurface and the motion at
/// infinity.
struct SurfaceKernel {
  SceneView scene;
  SampleIndex index;
  View<const Hit> hits;
  View<Vec3> position;     ///< metres, world space
  View<Vec3> previous;     ///< `position` one frame ago
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
      motion[pixel] = raster_motion_of_direction(scene, ray.direction);
      return;
    }
    SurfacePoint sp;
    make_surface_point(scene, ray, hit, scene.camera.cone_width() + scene.camera.cone_spread() * hit.t, sp);
    position[pixel] = sp.position;
    previous[pixel] = sp.previous_position;
    normal[pixel] = sp.frame.n;
    albedo[pixel] = glm::min(relume::albedo(sp.bsdf, glm::dot(sp.wo, sp.frame.n)) + sp.emission, Rgb(1));
    depth[pixel] = hit.t;
    motion[pixel] = raster_motion(scene, sp.position, sp.previous_position);
  }
};

/// Adds surface properties to the auxiliary layers; output divides by the number of samples. Motion is that of the
/// first sample, since nothing moves while samples accumulate.
struct AuxiliaryKernel {
  View<const Rgb> surface_albedo;
  View<const Vec3> surface_normal;
  View<const float> surface_depth;
  View<const Vec2> surface_motion;
  View<Rgb> albedo;
  View<Vec3> normal;
  View<float> depth;
  View<Vec2> motion;
  bool first = false;  ///< first sample after a change, the only one with motion
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
