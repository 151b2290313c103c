// Noise-free features for denoisers and histories: those of the first surface that scatters widely, seen directly, in
// mirrors or through smooth glass. Emission along the path is separate.
#pragma once

#include "core/triple.h"
#include "scene/medium.h"
#include "scene/prefetch.h"
#include "techniques/gbuffer/features/reflection.h"
#include "techniques/gbuffer/primary_hits/primary_hits.h"

namespace relume {

/// Maximum number of mirrors and interfaces followed.
inline constexpr uint32_t kMaxFeatureSteps = 8;
/// Albedos below this count as black in divisions: too dark for a display.
inline constexpr float kLeastAlbedo = 1e-3f;

/// The next step at a surface that mostly mirrors or transmits.
struct NarrowStep {
  Vec3 wi{0};       ///< world direction
  Rgb emission{0};  ///< factor for emission from there
  Rgb albedo{0};    ///< factor for albedo, as if all returned light came from there
  bool reflected = false;
  bool valid = false;
};

namespace feature_detail {

/// Local direction of a lobe's likelier branch. `share`: of the lobe's light; `eta_scale`: radiance factor of
/// refraction.
RELUME_HD inline Vec3 main_direction(const Bsdf& bsdf, int i, const Vec3& wo, Rgb* share, float* eta_scale) {
  const Lobe& lobe = bsdf.lobes[i];
  const Vec3 mirrored(-wo.x, -wo.y, wo.z);
  *share = Rgb(1);
  *eta_scale = 1.0f;
  if (bsdf.layered && bsdf.coat_has_normal && bsdf.is_coat(i)) {
    const Vec3 by_coat = reflect(wo, bsdf.detail.coat_normal);
    return by_coat.z > 0.0f ? by_coat : mirrored;
  }
  if (!transmits(lobe.kind)) return mirrored;
  if (!refracts(lobe.kind)) return -wo;
  const Interface& interface = bsdf.interface;
  const Rgb reflected = bsdf.layered ? dielectric::reflectance<true>(lobe, interface, bsdf.detail, wo.z)
                                     : dielectric::reflectance(interface, wo.z);
  const Rgb through = lobe.color * (Rgb(1) - reflected);
  const Rgb total = reflected + through;
  Vec3 wi;
  if (dielectric::reflection_probability(reflected) <= 0.5f && refract(wo, Vec3(0, 0, 1), interface.eta, &wi)) {
    for (int c = 0; c < 3; ++c) (*share)[c] = total[c] > 0.0f ? through[c] / total[c] : 0.0f;
    *eta_scale = transport_scale(interface.eta, TransportMode::radiance);
    return wi;
  }
  for (int c = 0; c < 3; ++c) (*share)[c] = total[c] > 0.0f ? reflected[c] / total[c] : 0.0f;
  return mirrored;
}

RELUME_HD inline bool has_narrow(const Bsdf& bsdf) {
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    if (is_narrow(bsdf.lobes[i])) return true;
  }
  return false;
}

}  // namespace feature_detail

/// The step along the largest narrow lobe. Invalid if other lobes return half of the light or more, since features then
/// describe this surface.
RELUME_HD inline NarrowStep narrow_step(const SurfacePoint& sp) {
  NarrowStep step;
  if (!feature_detail::has_narrow(sp.bsdf)) return step;
  const LayerTransmittance layers = layer_transmittance(sp.bsdf, sp.wo_local.z);
  Rgb total(0);
  Rgb largest(0);
  float narrow = 0;
  int chosen = -1;
  for (int i = 0; i < sp.bsdf.lobe_count; ++i) {
    const Lobe& lobe = sp.bsdf.lobes[i];
    const Rgb albedo = lobe_albedo(lobe, sp.bsdf.interface, *sp.bsdf.tables, sp.wo_local.z) * layers.to(sp.bsdf, i);
    total += albedo;
    if (!is_narrow(lobe)) continue;
    narrow += luminance(albedo);
    if (chosen >= 0 && luminance(albedo) <= luminance(largest)) continue;
    chosen = i;
    largest = albedo;
  }
  if (chosen < 0 || 2.0f * narrow <= luminance(total)) return step;
  Rgb share;
  float eta_scale = 1;
  const Vec3 wi = feature_detail::main_direction(sp.bsdf, chosen, sp.wo_local, &share, &eta_scale);
  step.wi = sp.frame.to_world(wi);
  step.reflected = wi.z > 0.0f;
  step.valid = glm::dot(step.wi, sp.ng) * wi.z > 0.0f;
  // As in BSDFs, emission includes the coat along wi; an albedo averages over all directions.
  const float coat_again = sp.bsdf.is_coat(chosen) ? 1.0f : coat_transmittance(sp.bsdf, wi.z);
  step.emission = largest * share * (eta_scale * coat_again);
  step.albedo = total * eta_scale;
  return step;
}

/// Features of one sample of a pixel.
struct Feature {
  Vec3 position{0};               ///< of the image in mirrors: along the camera ray, at the length of the path, metres
  Vec3 previous{0};               ///< position one frame ago
  Vec3 normal{0};                 ///< shading normal, mirrored back in the same way
  Rgb albedo{0};                  ///< of the surface, times the albedos along the path; black: no light to filter
  Rgb emission{0};                ///< emitted radiance, direct or through narrow lobes
  float depth = 0;                ///< length of the path, metres
  uint32_t surface = kNoSurface;  ///< differs between surfaces, and between a surface and its images
};

/// Follows mirrors and smooth interfaces from the primary hit on, for at most `max_steps` bounces.
struct FeatureTracer {
  const SceneView& scene;
  uint32_t max_steps = kMaxFeatureSteps;

  /// `reflection`: output, or nullptr if light is not split.
  RELUME_HD_INLINE Feature trace(const Ray& camera_ray, const Hit& hit, uint32_t ray_id,
                                 Reflection* reflection = nullptr) const {
    SurfacePoint sp;
    if (hit.valid())
      make_surface_point(scene, camera_ray, hit, scene.camera.cone_width() + scene.camera.cone_spread() * hit.t, sp);
    return trace(camera_ray, hit, ray_id, sp, reflection);
  }

  /// As above, for the surface point `sp` of the hit. Ignores `sp` if the hit is not valid.
  RELUME_HD_INLINE Feature trace(const Ray& camera_ray, const Hit& hit, uint32_t ray_id, const SurfacePoint& sp,
                                 Reflection* reflection) const {
    Feature f;
    if (!hit.valid()) {
      reach_background(camera_ray, camera_ray, Rgb(1), 0, f);
      return f;
    }
    // Fast path: most surfaces are seen directly, outside all media.
    const bool in_medium = !sp.front_face || !is_black(scene.camera_medium);
    if (in_medium || feature_detail::has_narrow(sp.bsdf)) return follow(camera_ray, hit, ray_id, sp, reflection);
    f.position = sp.position;
    f.previous = sp.previous_position;
    f.normal = sp.frame.n;
    f.albedo = is_lambert(sp.bsdf) ? sp.bsdf.lobes[0].color : relume::albedo(sp.bsdf, sp.wo_local.z);
    f.emission = sp.emission;
    f.depth = hit.t;
    f.surface = sp.instance;
    if (reflection) reflect(camera_ray, hit, sp, ray_id, Rgb(1), *reflection);
    return f;
  }

 private:
  /// Traces the reflection in the primary hit's specular lobes. `let_through`: transmittance to the camera.
  RELUME_HD void reflect(const Ray& camera_ray, const Hit& hit, const SurfacePoint& sp, uint32_t ray_id,
                         const Rgb& let_through, Reflection& reflection) const {
    if (specular_lobes(sp.bsdf) == SpecularLobes::none) return;
    Rgb albedo;
    const int chosen = reflection_detail::main_lobe(sp, &albedo);
    if (chosen < 0) return;
    const Lobe& lobe = sp.bsdf.lobes[chosen];
    const float alpha = is_delta(lobe.kind) ? 0.0f : lobe.alpha;
    if (alpha > kWidestReflection) return;
    Rgb share;
    float eta_scale = 1;
    const Vec3 wi_local = feature_detail::main_direction(sp.bsdf, chosen, sp.wo_local, &share, &eta_scale);
    const Vec3 wi = sp.frame.to_world(wi_local);
    if (!(glm::dot(wi, sp.ng) * wi_local.z > 0.0f)) return;
    reflection.albedo = albedo * let_through;
    ReflectionTracer{scene, camera_ray, hit, sp}.trace(wi, wi_local.z > 0.0f, alpha, hash(ray_id, kMaxFeatureSteps),
                                                       reflection);
  }

  /// Follows narrow lobes from the primary hit at `first`.
  RELUME_HD Feature follow(const Ray& camera_ray, Hit hit, uint32_t ray_id, const SurfacePoint& first,
                           Reflection* reflection) const {
    Feature f;
    SurfacePoint next_point;
    const SurfacePoint* at = &first;
    Rgb seen(1);
    Rgb medium = scene.camera_medium;  // absorption around the current segment
    Mat3 unfold(1);
    uint32_t path_id = 0;
    f.albedo = Rgb(1);
    f.depth = hit.t;
    for (uint32_t step = 0;; ++step) {
      const SurfacePoint& sp = *at;
      const Rgb let_through = transmittance_to(scene, sp, hit.t, medium);
      seen *= let_through;
      f.albedo *= let_through;
      f.emission += seen * sp.emission;
      const NarrowStep next = step < max_steps ? narrow_step(sp) : NarrowStep{};
      if (!next.valid) {
        if (reflection && step == 0) reflect(camera_ray, hit, sp, ray_id, let_through, *reflection);
        break;
      }
      seen *= next.emission;
      f.albedo *= next.albedo;
      path_id = hash(sp.instance, path_id + 1);
      if (next.reflected) unfold = unfold * mirror_matrix(sp.frame.n);
      const Ray ray = sp.spawn_ray(next.wi);
      medium = medium_along(scene, sp, next.wi, medium);
      hit = intersect(scene, ray, hash(ray_id, step));
      if (!hit.valid()) {
        reach_background(camera_ray, ray, seen, path_id, f);
        return f;
      }
      f.depth += hit.t;
      make_surface_point(scene, ray, hit, scene.camera.cone_width() + scene.camera.cone_spread() * f.depth, next_point);
      at = &next_point;
    }
    const SurfacePoint& sp = *at;
    f.albedo *= sp.bsdf.empty() ? Rgb(0) : relume::albedo(sp.bsdf, sp.wo_local.z);
    f.normal = unfold * sp.frame.n;
    f.position = path_id == 0 ? sp.position : camera_ray.origin + camera_ray.direction * f.depth;
    f.previous = f.position + unfold * (sp.previous_position - sp.position);
    f.surface = sp.instance ^ path_id;
    return f;
  }

  /// I − 2 n nᵀ.
  RELUME_HD static Mat3 mirror_matrix(const Vec3& n) { return Mat3(1) - 2.0f * glm::outerProduct(n, n); }

  RELUME_HD void reach_background(const Ray& camera_ray, const Ray& ray, const Rgb& seen, uint32_t path_id,
                                  Feature& f) const {
    const LightsView& lights = scene.lights;
    for (LightId id = lights.first_infinite; id < lights.lights.size; ++id)
      f.emission += seen * radiance_from_infinity(lights, id, ray.direction);
    f.albedo = Rgb(0);
    f.depth = kBackgroundDistance;
    f.position = f.previous = camera_ray.origin + camera_ray.direction * kBackgroundDistance;
    f.normal = -camera_ray.direction;
    f.surface = path_id == 0 ? kNoSurface : path_id;
  }
};

/// Scattered light over albedo: irradiance / π, the light of a white surface. Black channels take the largest of the
/// others.
RELUME_HD inline Rgb light_at_surface(const Rgb& scattered, const Rgb& albedo) {
  Rgb light(0);
  float largest = 0;
  for (int c = 0; c < 3; ++c) {
    if (albedo[c] < kLeastAlbedo) continue;
    light[c] = scattered[c] / albedo[c];
    largest = relume::max(largest, light[c]);
  }
  for (int c = 0; c < 3; ++c) {
    if (albedo[c] < kLeastAlbedo) light[c] = largest;
  }
  return light;
}

/// Whether the albedo is not black.
RELUME_HD inline bool is_filtered(const Rgb& albedo) { return max_component(albedo) >= kLeastAlbedo; }

/// The same for T = float, or Lanes for kLanes albedos.
template <typename T>
RELUME_HD_INLINE MaskOf<T> is_filtered(const Triple<T>& albedo) {
  return T(kLeastAlbedo) <= max(albedo.x, max(albedo.y, albedo.z));
}

/// light_at_surface() for T = float, or Lanes for kLanes pixels.
template <typename T>
RELUME_HD_INLINE Triple<T> light_at_surface(const Triple<T>& scattered, const Triple<T>& albedo) {
  const T zero(0.0f);
  const T least(kLeastAlbedo);
  Triple<T> light = {select(albedo.x < least, zero, scattered.x / albedo.x),
                     select(albedo.y < least, zero, scattered.y / albedo.y),
                     select(albedo.z < least, zero, scattered.z / albedo.z)};
  const T largest = max(max(max(zero, light.x), light.y), light.z);
  return {select(albedo.x < least, largest, light.x), select(albedo.y < least, largest, light.y),
          select(albedo.z < least, largest, light.z)};
}

/// Reflections of every pixel. Without one, `albedo` is black and the rest equals the features.
struct ReflectionViews {
  View<Rgb> diffuse_albedo;  ///< of lobes that are not specular; of all where `albedo` is black
  View<Rgb> albedo;
  View<Vec3> position;
  View<Vec3> previous;
  View<Vec3> normal;
  View<float> depth;
  View<Vec2> motion;  ///< of the image, pixels
};

struct FeatureKernel {
  SceneView scene;
  SampleIndex index;
  View<const Hit> hits;
  View<Vec3> position;
  View<Vec3> previous;
  View<Vec3> normal;
  View<Rgb> albedo;
  View<Rgb> emission;
  View<float> depth;
  View<Vec2> motion;  ///< pixels from the previous frame's position to this one's
  View<uint32_t> surface;
  uint32_t max_steps = kMaxFeatureSteps;
  bool camera_moved = true;  ///< since the previous frame
  uint32_t width = 0;
  ReflectionViews reflections = {};  ///< empty: light is not split

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    Sampler sampler = index.sampler(x, y);
    const Ray ray = lone_camera_ray(scene.camera, x, y, sampler);
    write(y * width + x, ray, sampler.camera_ray_id());
  }

  /// Generates camera rays in packets.
  void operator()(const Tile& tile) const {
    for (uint32_t y = tile.y0; y < tile.y1; y += 2) {
      for (uint32_t x = tile.x0; x < tile.x1; x += CameraPacket::kColumns) {
        CameraPacket packet;
        packet.take_rows(x, y, tile);
        packet.generate(scene.camera, index);
        uint32_t pixels[kPacketSize];
        for (int i = 0; i < packet.count; ++i) pixels[i] = packet.y[i] * width + packet.x[i];
        prefetch_surfaces(scene, hits.data, pixels, static_cast<uint32_t>(packet.count));
        for (int i = 0; i < packet.count; ++i) write(pixels[i], packet.rays[i], packet.ids[i]);
      }
    }
  }

  /// Host: writes one pixel from the surface point of its hit.
  void write(uint32_t pixel, const Ray& ray, uint32_t ray_id, const Hit& hit, const SurfacePoint& sp) const {
    Reflection reflection;
    store(pixel, ray, FeatureTracer{scene, max_steps}.trace(ray, hit, ray_id, sp, output(reflection)), reflection);
  }

 private:
  RELUME_HD_INLINE void write(uint32_t pixel, const Ray& ray, uint32_t ray_id) const {
    Reflection reflection;
    store(pixel, ray, FeatureTracer{scene, max_steps}.trace(ray, hits[pixel], ray_id, output(reflection)), reflection);
  }

  /// Where to store a reflection: nullptr if light is not split.
  RELUME_HD_INLINE Reflection* output(Reflection& reflection) const {
    return reflections.position.empty() ? nullptr : &reflection;
  }

  RELUME_HD_INLINE void store(uint32_t pixel, const Ray& ray, const Feature& f, const Reflection& reflection) const {
    position[pixel] = f.position;
    previous[pixel] = f.previous;
    normal[pixel] = f.normal;
    albedo[pixel] = f.albedo;
    emission[pixel] = f.emission;
    depth[pixel] = f.depth;
    surface[pixel] = f.surface;
    motion[pixel] = !camera_moved && f.previous == f.position ? Vec2(0) : motion_of(ray, f);
    if (!reflections.position.empty()) store_reflection(pixel, f, reflection);
  }

  RELUME_HD void store_reflection(uint32_t pixel, const Feature& f, const Reflection& r) const {
    const ReflectionViews& to = reflections;
    const bool shown = is_filtered(r.albedo);
    const Rgb rest = glm::max(f.albedo - r.albedo, Rgb(0));
    to.diffuse_albedo[pixel] = !shown ? f.albedo : is_filtered(rest) ? rest : Rgb(0);
    to.albedo[pixel] = shown ? r.albedo : Rgb(0);
    to.position[pixel] = shown ? r.position : f.position;
    to.previous[pixel] = shown ? r.previous : f.previous;
    to.normal[pixel] = shown ? r.normal : f.normal;
    to.depth[pixel] = shown ? r.depth : f.depth;
    if (!shown) {
      to.motion[pixel] = motion[pixel];
    } else if (!camera_moved && r.image == r.image_before) {
      to.motion[pixel] = Vec2(0);
    } else {
      to.motion[pixel] = raster_motion(scene, r.image, r.image_before);
    }
  }

  RELUME_HD Vec2 motion_of(const Ray& ray, const Feature& f) const {
    return f.surface == kNoSurface ? raster_motion_of_direction(scene, ray.direction)
                                   : raster_motion(scene, f.position, f.previous);
  }
};

}  // namespace relume
