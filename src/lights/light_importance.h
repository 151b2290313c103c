// Luminance that a point would reflect towards the viewer from each of many lights, without occlusion. Light selection
// strategies weight their candidates by this importance ([Dittebrandt20, §4.2]).
//
// Triangles and parallelograms are approximated by soft_form_factor() for a cosine lobe, and for a linearly transformed
// cosine ([Heitz16]). Point and spot lights are evaluated exactly. Emission is averaged over the light.
#pragma once

#include <vector>

#include "lights/light.h"
#include "materials/bsdf.h"
#include "materials/ltc.h"

namespace relume {

/// A finite light, reduced to the data for its importance: half a cache line.
struct alignas(32) CompactLight {
  Vec3 centre{0};      ///< centre of a triangle or parallelogram, metres
  Vec3 twice_area{0};  ///< normal times twice the area, m²
  float radius = 0;    ///< largest distance of a corner from the centre, metres; negative if the light is two-sided
  float emission = 0;  ///< luminance of the mean radiance; kPunctual for lights without extent, whose other data is 0

  static constexpr float kPunctual = -1;
  RELUME_HD bool is_punctual() const { return emission < 0.0f; }
};
static_assert(sizeof(CompactLight) == kLanes * sizeof(float));

/// Compact form of a finite light.
RELUME_HD inline CompactLight compact_form(const LightsView& view, const Light& light) {
  CompactLight compact;
  if (light.kind != LightKind::triangle) {
    compact.emission = CompactLight::kPunctual;
    return compact;
  }
  const TriangleLight& t = light.triangle;
  compact.centre = t.position(t.centre());
  compact.twice_area = 2.0f * t.area * t.normal;
  float radius2 = length_squared(t.v0 - compact.centre);
  radius2 = max(radius2, length_squared(t.v0 + t.e1 - compact.centre));
  radius2 = max(radius2, length_squared(t.v0 + t.e2 - compact.centre));
  compact.radius = t.two_sided ? -std::sqrt(radius2) : std::sqrt(radius2);
  const Rgb mean = t.textured < 0 ? Rgb(1) : view.textured.triangles[static_cast<uint32_t>(t.textured)].mean_emission;
  compact.emission = luminance(t.radiance * mean);
  return compact;
}

/// Compact forms of the finite lights of `view`, by id.
std::vector<CompactLight> compact_lights(const LightsView& view);

/// Surface point for which the importance is computed.
struct LightReceiver {
  Vec3 position{0};
  Frame frame;        ///< the viewer lies in the plane of t and n
  float diffuse = 0;  ///< albedo of cosine-like lobes, luminance
  float glossy = 0;   ///< albedo of glossy lobes, luminance
  float behind = 0;   ///< albedo of transmission from the other side, luminance
  LtcMatrix glossy_matrix;
};

/// Glossy reflection up to this fraction of the rest counts as diffuse, to save the second integral. Wide lobes use
/// kLittleGloss.
inline constexpr float kNegligibleGloss = 0.02f;
inline constexpr float kLittleGloss = 0.15f;
inline constexpr float kWideGloss = 0.7f;  ///< mean √α above which a lobe is wide

RELUME_HD inline LightReceiver make_light_receiver(const LtcTable& table, const Vec3& position, const Frame& shading,
                                                   const Vec3& wo_local, const Bsdf& bsdf) {
  LightReceiver r;
  r.position = position;
  const float sin_theta = std::sqrt(wo_local.x * wo_local.x + wo_local.y * wo_local.y);
  r.frame = shading;
  if (sin_theta > 1e-4f) {
    r.frame.t = shading.to_world({wo_local.x / sin_theta, wo_local.y / sin_theta, 0.0f});
    r.frame.b = glm::cross(shading.n, r.frame.t);
  }
  float roughness = 0;
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    const Lobe& lobe = bsdf.lobes[i];
    if (is_delta(lobe.kind)) continue;
    const float albedo = luminance(lobe_albedo(lobe, bsdf.interface, *bsdf.tables, wo_local.z));
    if (is_glossy(lobe.kind) && !transmits(lobe.kind)) {
      r.glossy += albedo;
      roughness += albedo * std::sqrt(lobe.alpha);
    } else if (is_rough_transmission(lobe.kind)) {
      // The direction of refraction is not modelled: half goes to each side, as a cosine lobe.
      r.behind += 0.5f * albedo;
      r.diffuse += 0.5f * albedo;
    } else {
      r.diffuse += albedo;
    }
  }
  const float rest = r.diffuse + r.behind;
  const float mean_roughness = r.glossy > 0.0f ? roughness / r.glossy : 1.0f;
  if (r.glossy <= (mean_roughness > kWideGloss ? kLittleGloss : kNegligibleGloss) * rest) {
    r.diffuse += r.glossy;
    r.glossy = 0;
  } else {
    r.glossy_matrix = table.at(wo_local.z, mean_roughness);
  }
  return r;
}

/// Approximate form factor, ∫ cos θ / π dω above the horizon, of a surface at `middle` for a receiver at the origin
/// that faces +Z: that of a point with the surface's projected area, which saturates at the cosine of its direction.
/// `volume`: projected area · distance. Within `radius` of the horizon the height fades to zero, so that every surface
/// that reaches above the horizon counts.
template <typename T>
RELUME_HD_INLINE T soft_form_factor(const Triple<T>& middle, const T& volume, const T& radius) {
  const T distance2 = max(dot(middle, middle), T(1e-30f));
  const T distance = square_root(distance2);
  const T above = max(middle.z + radius, T(0.0f));
  const T height = select(middle.z > radius, middle.z, above * above / (T(4.0f) * radius));
  return volume * height / (distance * (T(kPi) * distance2 * distance + volume));
}

/// Importance of a triangle or parallelogram. `middle`: its centre relative to the receiver, in world axes. `side`:
/// twice its area · the distance of its plane, > 0 on the emitting side. `radius`: largest distance of a corner from
/// the centre.
template <typename T>
RELUME_HD inline T triangle_importance(const LightReceiver& r, const Triple<T>& middle, T side, T radius, T emission) {
  const auto along = [&](const Vec3& axis) {
    return middle.x * T(axis.x) + middle.y * T(axis.y) + middle.z * T(axis.z);
  };
  const Triple<T> m{along(r.frame.t), along(r.frame.b), along(r.frame.n)};
  const T volume = T(0.5f) * side;
  T reflected = T(r.diffuse) * soft_form_factor(m, volume, radius);
  if (r.glossy > 0.0f) {
    const LtcMatrix& l = r.glossy_matrix;
    const Triple<T> transformed{m.x * T(l.a) + m.z * T(l.b), m.y * T(l.c), m.x * T(l.d) + m.z};
    const float stretch = std::sqrt(l.d * l.d + 1.0f);  // of heights
    reflected = reflected + T(r.glossy) * soft_form_factor(transformed, volume * T(std::fabs(l.determinant())),
                                                           radius * T(stretch));
  }
  if (r.behind > 0.0f)
    reflected = reflected + T(r.behind) * soft_form_factor(Triple<T>{m.x, m.y, T(0.0f) - m.z}, volume, radius);
  return select(side > T(0.0f), emission * reflected, T(0.0f));
}

/// Importance of a light without extent.
RELUME_HD inline float punctual_importance(const LightReceiver& r, const LightSample& s) {
  if (!s.valid()) return 0.0f;
  const Vec3 w = r.frame.to_local(s.wi);
  float reflected = kInvPi * (w.z > 0.0f ? r.diffuse * w.z : -r.behind * w.z);
  if (r.glossy > 0.0f && w.z > 0.0f) reflected += r.glossy * ltc_pdf(r.glossy_matrix, w);
  return luminance(s.radiance) * reflected;
}

/// Height above the horizon of a disk at `z` with the sine `radius`, faded as in soft_form_factor().
RELUME_HD inline float soft_height(float z, float radius) {
  if (z >= radius) return z;
  return z > -radius ? sqr(z + radius) / (4.0f * radius) : 0.0f;
}

/// Importance of a light at infinity without occlusion: of the centre of a sun, or of a sky with the mean radiance.
RELUME_HD inline float infinite_importance(const LightReceiver& r, const LightsView& lights, LightId id) {
  const Light& light = lights.lights[id];
  if (light.kind != LightKind::directional)
    return luminance(lights.environment.mean) * (r.diffuse + r.glossy + r.behind);
  const DirectionalLight& sun = light.directional;
  const Vec3 w = r.frame.to_local(sun.to_light);
  const float radius = std::sqrt(sun.one_minus_cos * (2.0f - sun.one_minus_cos));
  const float height = soft_height(w.z, radius);
  float reflected = kInvPi * (r.diffuse * height + r.behind * soft_height(-w.z, radius));
  if (r.glossy > 0.0f && height > 0.0f)
    reflected += r.glossy * ltc_pdf(r.glossy_matrix, glm::normalize(Vec3(w.x, w.y, height)));
  return luminance(sun.irradiance) * reflected;
}

namespace light_importance {

/// `e`: the members of CompactLight, of one light or of kLanes.
template <typename T>
RELUME_HD inline T of_members(const LightReceiver& r, const T (&e)[kLanes]) {
  const Triple<T> middle = Triple<T>{e[0], e[1], e[2]} - triple_of<T>(r.position);
  const T side = T(0.0f) - dot(Triple<T>{e[3], e[4], e[5]}, middle);
  const T radius = e[6];
  return triangle_importance<T>(r, middle, select(radius < T(0.0f), absolute(side), side), absolute(radius), e[7]);
}

}  // namespace light_importance

/// Importance of one finite light.
RELUME_HD inline float light_importance_of(const LightReceiver& r, const LightsView& lights,
                                           const View<const CompactLight>& compact, LightId id) {
  const CompactLight& e = compact[id];
  if (e.is_punctual()) return punctual_importance(r, sample_li_from_point(lights.lights[id], r.position));
  const float members[kLanes] = {e.centre.x,     e.centre.y,     e.centre.z, e.twice_area.x,
                                 e.twice_area.y, e.twice_area.z, e.radius,   e.emission};
  return light_importance::of_members<float>(r, members);
}

/// Calls use(i, importance) for the finite lights id_at(i) with i < `count`, in this order. Returns the sum of the
/// importances.
template <typename IdAt, typename Use>
RELUME_HD_INLINE float for_each_importance(const LightReceiver& r, const LightsView& lights,
                                           const View<const CompactLight>& compact, uint32_t count, const IdAt& id_at,
                                           const Use& use) {
  float sum = 0;
  const auto add = [&](uint32_t i, float importance) {
    use(i, importance);
    sum += importance;
  };
  if constexpr (kWidthOf<HostLanes> == 1) {
    for (uint32_t i = 0; i < count; ++i) add(i, light_importance_of(r, lights, compact, id_at(i)));
  } else {
    for (uint32_t first = 0; first < count; first += kLanes) {
      uint32_t block[kLanes];
      for (uint32_t k = 0; k < kLanes; ++k) block[k] = id_at(first + k < count ? first + k : first);
      Lanes members[kLanes];
      load_rows(&compact.data->centre.x, block, members);
      const Lanes importance = light_importance::of_members<Lanes>(r, members);
      const Lanes& emission = members[kLanes - 1];
      for (uint32_t k = 0; k < kLanes && first + k < count; ++k)
        add(first + k, emission[k] < 0.0f ? light_importance_of(r, lights, compact, block[k]) : importance[k]);
    }
  }
  return sum;
}

/// Importances of `count` finite lights; returns their sum.
RELUME_HD inline float light_importances(const LightReceiver& r, const LightsView& lights,
                                         const View<const CompactLight>& compact, const LightId* ids, uint32_t count,
                                         float* weights) {
  return for_each_importance(
      r, lights, compact, count, [&](uint32_t i) { return ids[i]; },
      [&](uint32_t i, float importance) { weights[i] = importance; });
}

}  // namespace relume
