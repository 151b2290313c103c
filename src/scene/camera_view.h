// Cameras for kernels: rays through a point on the image plane, and the importance used by light tracing and
// bidirectional methods. Raster coordinates are pixels, with (0, 0) at the top left corner.
#pragma once

#include "core/math.h"
#include "core/ray.h"
#include "core/view.h"
#include "sampling/warp.h"
#include "scene/scene.h"

namespace relume {

/// Pose of the camera at one key of the shutter.
struct CameraShutterKey {
  Vec3 position{0};
  Frame axes;
};

struct CameraView {
  Projection projection = Projection::perspective;
  Vec3 position{0};
  Frame axes;             ///< t right, b up, n backwards
  Vec2 half_extent{1};    ///< perspective: half size of the image at distance 1; orthographic: metres
  float lens_radius = 0;  ///< metres
  float focus_distance = 1;
  Vec2 resolution{1};
  bool shutter_open = false;               ///< whether paths have times of their own within the shutter
  float frame_time = -1;                   ///< time of all paths of the frame; negative: each path has its own
  View<const CameraShutterKey> keys = {};  ///< poses at the keys of the shutter; empty: the camera rests

  RELUME_HD float lens_area() const { return kPi * sqr(lens_radius); }
  /// Area of the image at distance 1 (perspective) or of the sensor (orthographic).
  RELUME_HD float image_area() const { return 4.0f * half_extent.x * half_extent.y; }
  /// Growth of a pixel's footprint per metre of distance, for ray cones.
  RELUME_HD float cone_spread() const {
    if (projection == Projection::perspective) return 2.0f * half_extent.y / resolution.y;
    return projection == Projection::panoramic ? kPi / resolution.y : 0.0f;
  }
  /// Width of a pixel's footprint at the camera, metres.
  RELUME_HD float cone_width() const {
    return projection == Projection::orthographic ? 2.0f * half_extent.y / resolution.y : 0.0f;
  }
};

/// Whether two cameras have the same view, ignoring resolution.
RELUME_HD inline bool same_view(const CameraView& a, const CameraView& b) {
  return a.projection == b.projection && a.position == b.position && a.axes.n == b.axes.n && a.axes.t == b.axes.t &&
         a.half_extent == b.half_extent && a.lens_radius == b.lens_radius && a.focus_distance == b.focus_distance;
}

/// The camera at a time within the shutter. Axes are interpolated linearly and orthonormalised.
RELUME_HD inline CameraView camera_at(const CameraView& c, float time) {
  if (c.keys.empty()) return c;
  const KeyTime at(time, c.keys.size);
  const CameraShutterKey& a = c.keys[at.first];
  const CameraShutterKey& b = c.keys[at.first + 1];
  CameraView placed = c;
  placed.position = at.mix(a.position, b.position);
  placed.axes.n = glm::normalize(at.mix(a.axes.n, b.axes.n));
  const Vec3 up = at.mix(a.axes.b, b.axes.b);
  placed.axes.t = glm::normalize(glm::cross(up, placed.axes.n));
  placed.axes.b = glm::cross(placed.axes.n, placed.axes.t);
  return placed;
}

namespace camera_detail {

/// Maps a raster position to [-1, 1]², +y up.
RELUME_HD inline Vec2 ndc_from_raster(const CameraView& c, const Vec2& raster) {
  return {2.0f * raster.x / c.resolution.x - 1.0f, 1.0f - 2.0f * raster.y / c.resolution.y};
}
RELUME_HD inline Vec2 raster_from_ndc(const CameraView& c, const Vec2& ndc) {
  return {0.5f * (ndc.x + 1.0f) * c.resolution.x, 0.5f * (1.0f - ndc.y) * c.resolution.y};
}

RELUME_HD inline Vec3 panoramic_direction(const CameraView& c, const Vec2& raster) {
  const Vec2 azimuth = math::unit_vector((raster.x / c.resolution.x - 0.5f) * (2.0f * kPi));
  const Vec2 polar = math::unit_vector(raster.y / c.resolution.y * kPi);
  return {polar.y * azimuth.y, polar.x, -polar.y * azimuth.x};
}

}  // namespace camera_detail

/// Ray through a raster position and, with a lens, through a point on the lens.
RELUME_HD_INLINE Ray generate(const CameraView& c, const Vec2& raster, const Vec2& u_lens) {
  Ray ray;
  const Vec2 ndc = camera_detail::ndc_from_raster(c, raster);
  switch (c.projection) {
    case Projection::perspective: {
      Vec3 direction(ndc.x * c.half_extent.x, ndc.y * c.half_extent.y, -1.0f);
      Vec3 origin(0);
      if (c.lens_radius > 0.0f) {
        const Vec2 lens = disk_from_square(u_lens) * c.lens_radius;
        origin = Vec3(lens, 0.0f);
        direction = direction * c.focus_distance - origin;
      }
      ray.origin = c.position + c.axes.to_world(origin);
      ray.direction = glm::normalize(c.axes.to_world(direction));
      break;
    }
    case Projection::orthographic:
      ray.origin = c.position + c.axes.to_world(Vec3(ndc.x * c.half_extent.x, ndc.y * c.half_extent.y, 0.0f));
      ray.direction = -c.axes.n;
      break;
    case Projection::panoramic:
      ray.origin = c.position;
      ray.direction = c.axes.to_world(camera_detail::panoramic_direction(c, raster));
      break;
  }
  return ray;
}

/// Finds the raster position that sees along `ray`. Returns false outside the image.
RELUME_HD inline bool raster_position(const CameraView& c, const Ray& ray, Vec2* raster) {
  const Vec3 direction = c.axes.to_local(ray.direction);
  const Vec3 origin = c.axes.to_local(ray.origin - c.position);
  Vec2 ndc;
  switch (c.projection) {
    case Projection::perspective: {
      if (direction.z >= 0.0f) return false;
      const float focus = c.lens_radius > 0.0f ? c.focus_distance : 1.0f;
      const Vec3 focal_point = origin + direction * (focus / -direction.z);
      ndc = Vec2(focal_point) / (focus * c.half_extent);
      break;
    }
    case Projection::orthographic: ndc = Vec2(origin) / c.half_extent; break;
    case Projection::panoramic: {
      const float u = 0.5f + math::atan2(direction.x, -direction.z) * (0.5f * kInvPi);
      const float v = math::acos(clamp(direction.y, -1.0f, 1.0f)) * kInvPi;
      // u is 1 straight back, v is 1 straight down.
      *raster = glm::min(Vec2(u, v), Vec2(kOneMinusEpsilon)) * c.resolution;
      return true;
    }
  }
  *raster = camera_detail::raster_from_ndc(c, ndc);
  return raster->x >= 0.0f && raster->x < c.resolution.x && raster->y >= 0.0f && raster->y < c.resolution.y;
}

/// Importance emitted along a ray that the camera could have generated. Its integral over the lens and the directions
/// of the whole image is 1 ([Pharr23], §16.1 of the third edition). Equals the camera's density per unit cosine.
RELUME_HD inline float we(const CameraView& c, const Ray& ray) {
  Vec2 raster;
  if (!raster_position(c, ray, &raster)) return 0.0f;
  const float lens = c.lens_radius > 0.0f ? c.lens_area() : 1.0f;
  switch (c.projection) {
    case Projection::perspective: {
      const float cos_theta = -glm::dot(ray.direction, c.axes.n);
      return 1.0f / (c.image_area() * lens * sqr(sqr(cos_theta)));
    }
    case Projection::orthographic: return 1.0f / c.image_area();
    case Projection::panoramic: {
      const Vec3 local = c.axes.to_local(ray.direction);
      const float sin_theta = std::sqrt(sqr(local.x) + sqr(local.z));  // 1 − y² cancels near the poles
      return sin_theta > 0.0f ? 1.0f / (2.0f * kPi * kPi * sin_theta) : 0.0f;
    }
  }
  return 0.0f;
}

struct CameraPdf {
  float pdf_a = 0;  ///< of the ray's origin on the lens or sensor; 1 for a point (delta)
  float pdf_w = 0;  ///< of its direction; 1 for orthographic cameras (delta)
};

/// pdf_we of a ray from generate(). Skips the test whether the ray is inside the image: rounding may put it outside.
RELUME_HD inline CameraPdf pdf_of_generated(const CameraView& c, const Ray& ray) {
  switch (c.projection) {
    case Projection::perspective: {
      const float cos_theta = -glm::dot(ray.direction, c.axes.n);
      return {c.lens_radius > 0.0f ? 1.0f / c.lens_area() : 1.0f, 1.0f / (c.image_area() * cos_theta * sqr(cos_theta))};
    }
    case Projection::orthographic: return {1.0f / c.image_area(), 1.0f};
    case Projection::panoramic: return {1.0f, we(c, ray)};
  }
  return {};
}

/// Densities with which generate() samples this ray for a raster position uniform over the image.
RELUME_HD inline CameraPdf pdf_we(const CameraView& c, const Ray& ray) {
  Vec2 raster;
  if (!raster_position(c, ray, &raster)) return {};
  return pdf_of_generated(c, ray);
}

/// Importance arriving at a point from the camera.
struct CameraSample {
  Vec3 wi{0};  ///< direction from the point to the camera
  float distance = 0;
  Vec3 normal{0};  ///< of the lens; zero for a panoramic camera
  Vec2 raster{0};
  float importance = 0;  ///< We
  float pdf_w = 0;  ///< density of wi; for a point camera the squared distance alone, for orthographic 1 (both delta)
  bool delta = false;

  RELUME_HD bool valid() const { return pdf_w > 0.0f && importance > 0.0f; }
};

RELUME_HD inline CameraSample sample_wi(const CameraView& c, const Vec3& p, const Vec2& u) {
  CameraSample s;
  Ray ray;  // from the camera to p
  if (c.projection == Projection::orthographic) {
    const float depth = -glm::dot(p - c.position, c.axes.n);
    if (depth <= 0.0f) return s;
    ray.direction = -c.axes.n;
    ray.origin = p - ray.direction * depth;
    s.distance = depth;
    s.pdf_w = 1.0f;
    s.delta = true;
    s.normal = ray.direction;
  } else {
    Vec2 lens(0);
    if (c.projection == Projection::perspective && c.lens_radius > 0.0f) lens = disk_from_square(u) * c.lens_radius;
    ray.origin = c.position + c.axes.to_world(Vec3(lens, 0.0f));
    const Vec3 d = p - ray.origin;
    s.distance = glm::length(d);
    if (!(s.distance > 0.0f)) return s;
    ray.direction = d / s.distance;
    s.pdf_w = sqr(s.distance);
    s.delta = c.projection == Projection::panoramic || c.lens_radius == 0.0f;
    if (c.projection == Projection::perspective) {
      s.normal = -c.axes.n;
      const float cos_lens = glm::dot(ray.direction, s.normal);
      if (cos_lens <= 0.0f) return {};
      s.pdf_w /= cos_lens;
      if (!s.delta) s.pdf_w /= c.lens_area();
    }
  }
  s.wi = -ray.direction;
  if (!raster_position(c, ray, &s.raster)) return {};
  s.importance = we(c, ray);
  return s;
}

}  // namespace relume
