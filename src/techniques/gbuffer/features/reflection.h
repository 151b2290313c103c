// Reflections in a pixel's surface, for filters and histories: a virtual image behind the surface, blurred by the
// lobe's width. Reflections move with that image, not with the surface.
#pragma once

#include "scene/ray_queries.h"
#include "scene/surface_point.h"
#include "techniques/temporal/reprojection/backward.h"

namespace relume {

/// Distance of the background, metres.
inline constexpr float kBackgroundDistance = 1e4f;
/// Lobes with an α above this have no reflection: their light counts as diffuse.
inline constexpr float kWidestReflection = 0.5f;

/// The virtual image in a surface's specular lobes.
struct Reflection {
  Rgb albedo{0};         ///< directional albedo of the specular lobes; black: light is not split
  Vec3 image{0};         ///< position of the virtual image, metres
  Vec3 image_before{0};  ///< position of the virtual image one frame ago
  /// Position for filters, metres: the image where it is sharp, the surface where the lobe blurs it.
  Vec3 position{0};
  Vec3 previous{0};  ///< `position` one frame ago
  Vec3 normal{0};
  /// Depth, metres, that scales the plane distance of validations; larger where `position` is between the two.
  float depth = 0;
};

namespace reflection_detail {

/// Index of the specular lobe that returns the most light, or −1. `albedo`: sum over all specular lobes.
RELUME_HD inline int main_lobe(const SurfacePoint& sp, Rgb* albedo) {
  const LayerTransmittance layers = layer_transmittance(sp.bsdf, sp.wo_local.z);
  float most = 0;
  int chosen = -1;
  *albedo = Rgb(0);
  for (int i = 0; i < sp.bsdf.lobe_count; ++i) {
    const Lobe& lobe = sp.bsdf.lobes[i];
    if (!is_specular(lobe.kind)) continue;
    const Rgb returned = lobe_albedo(lobe, sp.bsdf.interface, *sp.bsdf.tables, sp.wo_local.z) * layers.to(sp.bsdf, i);
    *albedo += returned;
    if (luminance(returned) <= most) continue;
    most = luminance(returned);
    chosen = i;
  }
  return chosen;
}

/// Mean curvature of the interpolated normals across the triangle at `hit`, 1/m; positive if convex on the side of
/// `normal`.
RELUME_HD inline float curvature(const SceneView& scene, const Hit& hit, const Vec3& normal) {
  const Instance& instance = scene.instances[hit.instance];
  const MeshView& mesh = scene.meshes[instance.mesh];
  if (!mesh.has_normals) return 0.0f;
  const surface_detail::TriangleAt t = surface_detail::triangle_at(scene, mesh, hit.primitive, hit.u, hit.v);
  Vec3 p[3];
  Vec3 n[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = instance.in_world_space ? t.v[i]->position : instance.to_world.point(t.v[i]->position);
    n[i] = t.v[i]->normal.unpack();
    if (!instance.in_world_space) n[i] = instance.normal_to_world * n[i];
    n[i] = glm::normalize(n[i]);
  }
  float sum = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 along = p[(i + 1) % 3] - p[i];
    const float square = length_squared(along);
    if (square > 0.0f) sum += glm::dot(n[(i + 1) % 3] - n[i], along) / square;
  }
  const float mean = sum / 3.0f;
  if (!is_finite(mean)) return 0.0f;
  return glm::dot(n[0], normal) < 0.0f ? -mean : mean;
}

/// Distance of the image behind a spherical mirror, metres, of an object at `distance`. Magnification is limited to 4;
/// real images of concave mirrors are not followed.
RELUME_HD inline float image_distance(float distance, float curvature) {
  return distance / relume::max(1.0f + 2.0f * curvature * distance, 0.25f);
}

}  // namespace reflection_detail

/// Traces one ray along the main direction of the largest specular lobe. `sp`: surface point of `hit` on `camera_ray`.
struct ReflectionTracer {
  const SceneView& scene;
  const Ray& camera_ray;
  const Hit& hit;
  const SurfacePoint& sp;

  /// `wi`: main direction, world space; `alpha`: width of the lobe. Sets all of `r` except the albedo.
  RELUME_HD void trace(const Vec3& wi, bool reflected, float alpha, uint32_t ray_id, Reflection& r) const {
    using namespace reflection_detail;
    const Ray ray = sp.spawn_ray(wi);
    const Hit seen = intersect(scene, ray, ray_id);
    const float distance = seen.valid() ? seen.t : kBackgroundDistance;
    const float bend = reflected ? curvature(scene, hit, sp.frame.n) : 0.0f;
    const float behind = image_distance(distance, bend);
    r.image = sp.position + camera_ray.direction * behind;
    const Vec3 carried = sp.previous_position - sp.position;
    Vec3 moved = reflected ? sp.frame.n * (2.0f * glm::dot(sp.frame.n, carried)) : Vec3(0);
    if (seen.valid()) {
      const SurfacePosition shown = surface_position(scene, seen);
      moved += unfolded(shown.before - shown.now, reflected);
    }
    r.image_before = r.image + moved;
    const float footprint = scene.camera.cone_width() + scene.camera.cone_spread() * (hit.t + behind);
    const float blur = 2.0f * alpha * behind / footprint;  // radius of the lobe at the image, pixels
    const float sharpness = 1.0f / (1.0f + sqr(sqr(0.5f * blur)));
    const float offset = behind * sharpness;
    r.position = sp.position + camera_ray.direction * offset;
    r.previous = r.position + carried + (moved - carried) * sharpness;
    r.depth = hit.t + offset + (1.0f - sharpness) * offset / kBackwardPlaneDistance;
    r.normal = sp.frame.n;
    constexpr float kSharp = 0.1f;  // below this, the reflected normal is not needed
    if (!seen.valid() || sharpness < kSharp) return;
    SurfacePoint shown;
    make_surface_point(scene, ray, seen, footprint, shown);
    const Vec3 mixed = sp.frame.n * (1.0f - sharpness) + unfolded(shown.frame.n, reflected) * sharpness;
    if (length_squared(mixed) > 1e-4f) r.normal = glm::normalize(mixed);
  }

 private:
  RELUME_HD Vec3 unfolded(const Vec3& v, bool reflected) const {
    return reflected ? v - sp.frame.n * (2.0f * glm::dot(sp.frame.n, v)) : v;
  }
};

}  // namespace relume
