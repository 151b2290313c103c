// Gradients of A-SVGF ([Schied18]): the change of a pixel's light between two frames at the same surface point with the
// same random numbers. One pixel of each stratum of the previous frame is projected to this frame, and its path traced
// again. Where nothing has changed, both paths have the same bits, so the noise cancels.
#pragma once

#include "techniques/temporal/reprojection/reprojection.h"
#include "techniques/transport/path/walk.h"

namespace relume {

/// Edge of a stratum, pixels.
inline constexpr uint32_t kStratum = 3;
RELUME_HD constexpr uint32_t strata(uint32_t size) { return (size + kStratum - 1) / kStratum; }

/// Sample of one pixel of a stratum, to be traced again in the next frame.
struct GradientSample {
  Hit hit;               ///< primary hit; instance kNoHit: no sample
  uint32_t pixel = 0;    ///< index in the frame that traced it
  uint32_t element = 0;  ///< SampleIndex::sample_of() the pixel in that frame
  float luminance = 0;   ///< of the sample's radiance without the emission of the first surface
};

/// Luminance of scattered radiance: that of the whole path, without `emission` of the first surface.
RELUME_HD inline float scattered_luminance(const Rgb& radiance, const Rgb& emission) {
  return relume::max(luminance(radiance - emission), 0.0f);
}

/// Stores the sample of a random pixel per stratum. Grid: strata of this frame.
struct RecordSamplesKernel {
  PathContext context;
  SampleIndex index;
  View<const Hit> hits;
  View<const Rgb> radiance;         ///< of this frame's paths, before any other pass changes it
  View<const uint32_t> allocation;  ///< samples of each pixel, 0 or 1; empty: 1
  View<GradientSample> samples;
  uint32_t columns = 0;  ///< of strata
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    constexpr uint32_t kPixels = kStratum * kStratum;
    constexpr uint32_t kSalt = 0x632be5abu;
    GradientSample& sample = samples[y * columns + x];
    sample = {};
    const uint32_t first = hash(hash(index.seed ^ kSalt, index.frame), x, y) % kPixels;
    for (uint32_t k = 0; k < kPixels && !sample.hit.valid(); ++k) {
      const uint32_t cell = (first + k) % kPixels;
      const uint32_t px = x * kStratum + cell % kStratum;
      const uint32_t py = y * kStratum + cell / kStratum;
      if (px < width && py < height) record(px, py, sample);
    }
  }

 private:
  RELUME_HD void record(uint32_t x, uint32_t y, GradientSample& sample) const {
    const uint32_t pixel = y * width + x;
    if (!allocation.empty() && allocation[pixel] == 0) return;
    if (!hits[pixel].valid() || !is_finite(radiance[pixel])) return;
    Sampler sampler = index.sampler(x, y);
    PathState path = start_path(context, x, y, sampler);
    SurfacePoint sp;
    sp.position = path.ray.origin;
    sp.bsdf.lobe_count = 0;  // the camera
    NoPolicy policy;
    arrive(context, hits[pixel], sp, path, policy);
    if (!is_finite(path.radiance)) return;
    sample = {hits[pixel], pixel, index.sample_of(x, y), scattered_luminance(radiance[pixel], path.radiance)};
  }
};

/// Projects the previous frame's samples to this frame's strata. Of those that fall into the same stratum, the nearest
/// one wins, then the lowest index. Grid: strata of the previous frame.
struct ProjectSamplesKernel {
  SceneView scene;
  View<const GradientSample> samples;  ///< of the previous frame
  View<uint64_t> votes;                ///< vote_of() by stratum of this frame; kNoVote at first
  uint32_t columns = 0;
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t stratum = y * columns + x;
    const Hit& hit = samples[stratum].hit;
    if (!exists(samples[stratum])) return;
    const Vec3 p = surface_position(scene, hit).now;
    Vec2 raster;
    if (!raster_position_of(scene.camera, p, &raster)) return;
    if (!(raster.x >= 0.0f && raster.x < static_cast<float>(width))) return;
    if (!(raster.y >= 0.0f && raster.y < static_cast<float>(height))) return;
    const float depth = depth_of(p);
    if (!(depth > 0.0f)) return;
    const uint32_t column = relume::min(math::truncate_to_uint(raster.x), width - 1) / kStratum;
    const uint32_t row = relume::min(math::truncate_to_uint(raster.y), height - 1) / kStratum;
    atomic_min(&votes[row * columns + column], vote_of(depth, stratum));
  }

 private:
  /// Whether the sample refers to a visible surface; a damaged checkpoint may hold any numbers.
  RELUME_HD bool exists(const GradientSample& sample) const {
    const Hit& hit = sample.hit;
    if (hit.instance >= scene.instances.size || sample.pixel >= width * height) return false;
    const Instance& instance = scene.instances[hit.instance];
    return instance.visible && hit.primitive < scene.meshes[instance.mesh].triangle_count && is_finite(hit.u) &&
           is_finite(hit.v) && is_finite(hit.t) && is_finite(sample.luminance);
  }

  RELUME_HD float depth_of(const Vec3& p) const {
    const Vec3 d = p - scene.camera.position;
    return scene.camera.projection == Projection::orthographic ? -glm::dot(d, scene.camera.axes.n) : glm::length(d);
  }
};

/// Tests the first vertex of a path that is traced again.
struct GradientPolicy : NoPolicy {
  const SceneView* scene = nullptr;
  Ray view;                     ///< from this frame's camera to the first vertex; t_max: their distance
  uint32_t ray_id = 0;          ///< of the camera ray
  bool same_direction = false;  ///< whether the path begins along the same ray as in the previous frame
  bool usable = false;          ///< whether the first vertex is visible and its shading can be compared
  Rgb emission{0};              ///< of the first surface

  RELUME_HD void emitted(const PathState& path, bool /*covered_by_nee*/) {
    if (path.bounce == 0) emission = path.radiance;
  }
  RELUME_HD bool arrived(const SurfacePoint& sp, const PathState& path) {
    if (path.bounce > 0) return true;
    // From another direction, a mirror shows another place.
    if (!same_direction && near_specular(sp.bsdf)) return false;
    usable = !occluded_to_camera(*scene, shadow_ray(sp, -view.direction, view.t_max), ray_id);
    return usable;
  }
};

/// Traces the projected samples with their own random numbers in this frame's scene, and compares. Grid: strata of this
/// frame.
struct TraceGradientsKernel {
  PathContext context;                 ///< its camera is the one from which samples are shaded
  CameraView camera;                   ///< of this frame
  SampleIndex index;                   ///< of the previous frame; each sample stores its element
  View<const GradientSample> samples;  ///< of the previous frame
  View<const uint64_t> votes;
  View<Vec2> gradients;    ///< δ = luminance now − before, Δ = the larger of both; 0 without a sample
  View<uint32_t> rays;     ///< per pixel of this frame; the middle pixel of the stratum counts the rays
  bool same_view = false;  ///< whether the camera of the context is that of the previous frame
  uint32_t columns = 0;
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t stratum = y * columns + x;
    gradients[stratum] = Vec2(0);
    if (votes[stratum] == kNoVote) return;
    const GradientSample& sample = samples[static_cast<uint32_t>(votes[stratum])];
    const uint32_t px = sample.pixel % width;
    const uint32_t py = sample.pixel / width;
    SampleIndex replayed = index;
    replayed.sample = sample.element;
    Sampler sampler = replayed.sampler(px, py);
    PathState path = start_path(context, px, py, sampler);
    const SurfacePosition p = surface_position(context.scene, sample.hit);
    GradientPolicy policy;
    policy.scene = &context.scene;
    policy.view = ray_to(camera, camera.position, p.now);
    policy.ray_id = sampler.camera_ray_id();
    policy.same_direction = same_view && p.now == p.before;
    // Where nothing moved, the camera ray keeps its bits. Elsewhere it passes the same point of the lens.
    if (!policy.same_direction) path.ray = ray_to(context.scene.camera, path.ray.origin, p.now);
    path.ray.t_max = kInfinity;
    if (!(policy.view.t_max > 0.0f) || !is_finite(path.ray.direction)) return;
    SurfacePoint sp;
    sp.position = path.ray.origin;
    sp.bsdf.lobe_count = 0;  // the camera
    // The sample keeps its distance from the camera, and with it the footprint that selects texture levels.
    walk(context, sample.hit, sp, path, sampler, policy);
    const uint32_t middle_x = relume::min(x * kStratum + kStratum / 2, width - 1);
    const uint32_t middle_y = relume::min(y * kStratum + kStratum / 2, height - 1);
    rays[middle_y * width + middle_x] += path.rays;
    if (!policy.usable || !is_finite(path.radiance)) return;
    const float now = scattered_luminance(path.radiance, policy.emission);
    gradients[stratum] = {now - sample.luminance, relume::max(now, sample.luminance)};
  }

 private:
  /// Ray from `origin`, a point of the camera's lens, to `p`; t_max is their distance. Rays of an orthographic camera
  /// begin on its plane.
  RELUME_HD static Ray ray_to(const CameraView& from, const Vec3& origin, const Vec3& p) {
    if (from.projection == Projection::orthographic) {
      const float depth = -glm::dot(p - from.position, from.axes.n);
      return {p + from.axes.n * depth, -from.axes.n, depth};
    }
    const Vec3 d = p - origin;
    const float distance = glm::length(d);
    return {origin, d / distance, distance};
  }
};

}  // namespace relume
